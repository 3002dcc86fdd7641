# SPDX-License-Identifier: Apache-2.0
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "experiments/ask"))

import ask_bars  # noqa: E402
import judge  # noqa: E402

PICK = "Skill/Event/robot/pick/2026-01-01 08:00:02.800000/0"
WORDS = "Speech/Commands/human/text/2026-01-01 08:00:00.500000/0"


def dialogue(value, also=(), evidence=(PICK,), **more):
    return {"value": value, "also": list(also), "evidence": list(evidence), "family": "events",
            "form": "how_often", "held_out": [], "answerable": value["kind"] != "unknown", **more}


def answer(value, *evidence, **more):
    return {"value": value, "evidence": [{"id": one, "role": "event"} for one in evidence], **more}


def is_right(wanted, given, *evidence):
    return judge.is_right(dialogue(wanted), answer(given, *evidence))


def test_times_are_right_within_half_a_second():
    wanted = {"kind": "time", "value": "2026-01-01 08:00:02.800000"}
    assert is_right(wanted, {"kind": "time", "value": "2026-01-01 08:00:03.3"})
    assert not is_right(wanted, {"kind": "time", "value": "2026-01-01 08:00:03.4"})
    # Across midnight, and without a fraction.
    assert judge.are_near("2026-01-01 23:59:59.8", "2026-01-02T00:00:00Z")


def test_amounts_are_right_within_a_tenth_of_their_unit():
    wanted = {"kind": "seconds", "value": 30.0}
    assert is_right(wanted, {"kind": "seconds", "value": 30.1})
    assert not is_right(wanted, {"kind": "seconds", "value": 30.11})
    assert is_right({"kind": "metres", "value": 0.2}, {"kind": "metres", "value": 0.3})
    assert not is_right({"kind": "metres", "value": 9.0}, {"kind": "metres", "value": 9.2})


def test_names_and_events_are_sets():
    assert is_right({"kind": "names", "value": ["salt", "tea"]},
                    {"kind": "names", "value": ["the tea", "Salt"]})
    assert not is_right({"kind": "names", "value": ["salt", "tea"]},
                        {"kind": "names", "value": ["salt"]})
    assert is_right({"kind": "names", "value": ["right"]},
                    {"kind": "names", "value": ["right hand"]})
    assert is_right({"kind": "events", "value": [PICK]}, {"kind": "events", "value": [PICK]})
    assert not is_right({"kind": "events", "value": [PICK]}, {"kind": "events", "value": []})


def test_a_reason_is_right_by_its_links():
    wanted = dialogue({"kind": "reason", "value": "told to", "links": [WORDS]}, evidence=[WORDS])
    given = {"kind": "reason", "value": "other words", "links": [PICK, WORDS]}
    assert judge.is_right(wanted, answer(given))
    # What stands beside it as evidence is no reason.
    assert not judge.is_right(wanted, answer({**given, "links": [PICK]}, WORDS))


def test_other_right_answers_count():
    wanted = dialogue({"kind": "count", "value": 2}, also=[{"kind": "count", "value": 3}])
    assert judge.is_right(wanted, answer({"kind": "count", "value": 3}))
    assert not judge.is_right(wanted, answer({"kind": "count", "value": 1}))
    # True is no 1.
    assert not judge.is_right(dialogue({"kind": "count", "value": 1}),
                              answer({"kind": "yes_no", "value": True}))


def test_not_to_know_is_right_only_where_nothing_is_known():
    unknown = {"kind": "unknown"}
    assert not judge.is_right(dialogue({"kind": "count", "value": 0}, also=[unknown], evidence=[]),
                              answer(unknown))
    assert judge.is_right(dialogue(unknown, evidence=[]), answer(unknown))
    assert not judge.is_right(dialogue(unknown, evidence=[]), answer({"kind": "count", "value": 0}))


def test_what_nothing_shows_is_shown_by_nothing():
    nothing = dialogue({"kind": "count", "value": 0}, evidence=[])
    assert judge.is_shown(nothing, answer({"kind": "count", "value": 0}, PICK)) is None
    something = dialogue({"kind": "count", "value": 1})
    assert judge.is_shown(something, answer({"kind": "count", "value": 1}, WORDS)) is False
    assert judge.is_shown(something, answer({"kind": "count", "value": 1}, WORDS, PICK)) is True


def test_what_came_after_the_question_is_later():
    assert judge.is_later(PICK, "2026-01-01 08:00:02.7")
    assert not judge.is_later(PICK, "2026-01-01 08:00:02.8")


def test_figures_are_of_what_they_say():
    two = {"kind": "count", "value": 2}
    unknown = {"kind": "unknown"}

    def row(value, given, family, took_ms, shows=(PICK,), evidence=(PICK,)):
        wanted = dialogue(value, family=family, evidence=evidence, now="2026-01-01 08:00:30")
        return ask_bars.row_of(wanted, answer(given, *shows, took_ms=took_ms), {PICK, WORDS},
                               {"value": two})

    figures = ask_bars.summary([
        row(two, two, "events", 10),
        row(two, {"kind": "count", "value": 3}, "events", 20),
        row(two, unknown, "problems", 30, shows=()),
        row(unknown, unknown, "unanswerable", 400, shows=(), evidence=()),
        # Right, but shown by something else, or by what does not exist.
        row(two, two, "problems", 40, shows=(WORDS,)),
        row(two, two, "problems", 50, shows=(PICK, PICK.rpartition("/")[0])),
        # Nothing shows it, so that it says nothing about what is shown.
        row(two, two, "problems", 60, shows=(WORDS,), evidence=())])
    assert figures["right"] == 4 / 6
    assert figures["unanswerable_refused"] == 1
    assert figures["said"] == 5 and figures["said_with_evidence"] == 4 / 5
    assert figures["said_of_later"] == 0
    assert figures["provable"] == 5 and figures["right_and_shown"] == 1 / 5
    assert figures["right_that_are_shown"] == 2 / 3
    assert figures["families"]["events"] == {"questions": 2, "right": 0.5, "refused": 0, "blind": 1}
    assert figures["families"]["problems"]["refused"] == 1 / 4
    assert figures["forms"]["how_often"]["questions"] == 7
    assert figures["p95_ms"] == 400


def test_the_blind_know_only_other_kitchens():
    two, three = {"kind": "count", "value": 2}, {"kind": "count", "value": 3}
    by_store = {"a": [dialogue(two), dialogue(two)], "b": [dialogue(three)]}
    blind = ask_bars.blind_answers(by_store)
    assert blind("b", by_store["b"][0])["value"] == two
    assert blind("a", by_store["a"][0])["value"] == three
    assert blind("a", dialogue(two, form="when_did_you"))["value"] == {"kind": "unknown"}
    # Of a single kitchen there is nothing to guess from.
    assert ask_bars.blind_answers({"a": by_store["a"]})("a", by_store["a"][0]) is None


def test_questions_are_as_many_as_were_asked_for():
    by_store = {"a": [1, 2, 3], "b": [1, 2, 3], "c": []}
    assert {store: len(all) for store, all in ask_bars.trimmed(by_store, 5).items()} == {
        "a": 3, "b": 2, "c": 0}


def test_each_template_is_asked_as_often_as_another():
    def asked(name, count):
        return [dialogue({"kind": "count", "value": 1}, phrasing=f"{name}/pick*.{i}+small")
                for i in range(count)]

    by_store = {"a": asked("how_often#w01", 9) + asked("did_you:any#w02", 1),
                "b": asked("how_often#w01", 9) + asked("foreign#3", 2)}
    chosen = ask_bars.chosen_evenly(by_store, 7, seed=1)
    names = [ask_bars.template_of(one) for of_store in chosen.values() for one in of_store]
    assert {name: names.count(name) for name in names} == {
        "how_often#w01": 4, "did_you:any#w02": 1, "foreign#3": 2}
    assert ask_bars.chosen_evenly(by_store, 7, seed=1) == chosen
    assert sum(map(len, ask_bars.chosen_evenly(by_store, 99, seed=1).values())) == 21


def test_lines_that_fit_nothing_are_counted(tmp_path):
    file = tmp_path / "lines.jsonl"
    file.write_text('{"form": "how_often", "question": "A?"}\n\n'
                    '{"form": "how_often", "question": "A?"}\n'
                    '{"form": "how_often", "question": "B?"}\n'
                    '{"asks": {"what": "where_now"}, "question": "A?"}\n')
    one, two = ({"phrasing": "how_often#w1"}, {"phrasing": "foreign#3"})
    assert ask_bars.lines_asked(file, {"a": [one, two]}, {"a": [one]}) == {
        "lines": 3, "asked": 1, "left_out": 1, "fit_nothing": 1}


def test_days_are_those_of_the_calendar():
    assert ask_bars.start_of_day(0) == "2026-03-01 09:00:00"
    assert ask_bars.start_of_day(60) == "2026-04-30 09:00:00"
    assert ask_bars.start_of_day(61) == "2026-05-01 09:00:00"


def test_hostile_texts_are_repeated():
    assert ask_bars.hostile_text('{"kind": "long", "question": "word ", "repeat": 3}') == (
        "word word word ")
    lines = (pathlib.Path(ask_bars.__file__).parent / "hostile.jsonl").read_text().splitlines()
    texts = [ask_bars.hostile_text(line) for line in lines]
    assert len(set(texts)) == 80
    assert max(len(text.split()) for text in texts) == 10_000
