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


def test_durations_are_right_within_a_tenth():
    wanted = {"kind": "seconds", "value": 3.0}
    assert is_right(wanted, {"kind": "seconds", "value": 3.29})
    assert not is_right(wanted, {"kind": "seconds", "value": 3.4})
    assert is_right({"kind": "metres", "value": 0.2}, {"kind": "metres", "value": 0.24})


def test_names_and_events_are_sets():
    assert is_right({"kind": "names", "value": ["salt", "tea"]},
                    {"kind": "names", "value": ["the tea", "Salt"]})
    assert not is_right({"kind": "names", "value": ["salt", "tea"]},
                        {"kind": "names", "value": ["salt"]})
    assert is_right({"kind": "names", "value": ["right"]},
                    {"kind": "names", "value": ["right hand"]})
    assert is_right({"kind": "events", "value": [PICK]}, {"kind": "events", "value": [PICK]})
    assert not is_right({"kind": "events", "value": [PICK]}, {"kind": "events", "value": []})


def test_a_reason_is_right_by_what_it_shows():
    wanted = dialogue({"kind": "reason", "value": "told to", "links": [WORDS]}, evidence=[WORDS])
    given = {"kind": "reason", "value": "other words", "links": []}
    assert judge.is_right(wanted, answer(given, WORDS))
    assert not judge.is_right(wanted, answer(given, PICK))
    assert judge.is_right(wanted, answer({**given, "links": [WORDS]}))


def test_other_right_answers_count():
    wanted = dialogue({"kind": "count", "value": 0}, also=[{"kind": "unknown"}], evidence=[])
    assert judge.is_right(wanted, answer({"kind": "unknown"}))
    assert judge.is_right(wanted, answer({"kind": "count", "value": 0}))
    assert not judge.is_right(wanted, answer({"kind": "count", "value": 1}))
    # True is no 1.
    assert not judge.is_right(dialogue({"kind": "count", "value": 1}),
                              answer({"kind": "yes_no", "value": True}))


def test_figures_are_of_what_they_say():
    def row(value, given, family, **more):
        wanted = dialogue(value, family=family)
        said = answer(given, PICK)
        return {"dialogue": wanted, "answer": said, "right": judge.is_right(wanted, said),
                "refused": judge.is_refused(said), "blind": False, "has_evidence": True,
                "is_shown": judge.is_shown(wanted, said), **more}

    two = {"kind": "count", "value": 2}
    unknown = {"kind": "unknown"}
    figures = ask_bars.summary([
        row(two, two, "events", took_ms=10), row(two, {"kind": "count", "value": 3}, "events",
                                                 took_ms=20),
        row(two, unknown, "problems", took_ms=30), row(unknown, unknown, "unanswerable",
                                                       took_ms=400)])
    assert figures["right"] == 1 / 3
    assert figures["unanswerable_refused"] == 1
    assert figures["said"] == 2 and figures["said_with_evidence"] == 1
    assert figures["families"]["events"]["right"] == 0.5
    assert figures["families"]["problems"]["refused"] == 1
    assert figures["p95_ms"] == 400


def test_the_blind_know_only_other_kitchens():
    two, three = {"kind": "count", "value": 2}, {"kind": "count", "value": 3}
    by_store = {"a": [dialogue(two), dialogue(two)], "b": [dialogue(three)]}
    blind = ask_bars.blind_answers(by_store)
    assert blind("b", by_store["b"][0])["value"] == two
    assert blind("a", by_store["a"][0])["value"] == three
    assert blind("a", dialogue(two, form="when_did_you"))["value"] == {"kind": "unknown"}


def test_questions_are_as_many_as_were_asked_for():
    by_store = {"a": [1, 2, 3], "b": [1, 2, 3], "c": []}
    assert {store: len(all) for store, all in ask_bars.trimmed(by_store, 5).items()} == {
        "a": 3, "b": 2, "c": 0}
