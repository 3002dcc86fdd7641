# SPDX-License-Identifier: Apache-2.0
"""Scores fail where answers are wrong, late, missing or only the full store's."""

import pathlib
import sys

import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[3] / "experiments" / "forgetting"
sys.path.insert(0, str(FOLDER))
import days  # noqa: E402
import ninety_days  # noqa: E402
import scores  # noqa: E402

SECOND = days.SECOND
NOW = 100 * scores.DAY


def question(kind, ask, truth, age_days=1, **more):
    moment = int(NOW - age_days * scores.DAY)
    return {"number": 0, "kind": kind, "ask": ask, "truth": truth, "time": moment, "moment": moment,
            **more}


def numbered(*questions):
    return [one | {"number": i} for i, one in enumerate(questions)]


@pytest.mark.parametrize("kind, ask, truth, right, wrong", [
    ("where", "object", [1.0, 2.0, 3.0], [1.0, 2.0, 3.049], [1.04, 2.04, 3.0]),
    ("where", "robot", [1.0, 2.0], [1.0, 1.951], [1.0, 2.051]),
    ("when", "picked", 9 * SECOND, 11 * SECOND, 11 * SECOND + 1),
    ("when", "seen", 9 * SECOND, 9 * SECOND - SECOND // 2, 9 * SECOND - SECOND // 2 - 1),
    ("what", "image", 3, 3, 4),
    ("what", "doing", ["pick", "tea_box"], ["pick", "tea_box"], ["pick", "salt_box"]),
    ("what", "said", "Stop!", "Stop!", "Go on.")])
def test_an_answer_is_right_or_wrong(kind, ask, truth, right, wrong):
    asked = question(kind, ask, truth)
    assert scores.is_right(asked, right)
    assert not scores.is_right(asked, wrong)
    assert not scores.is_right(asked, None), "no answer"


def test_only_what_the_full_store_answers_counts():
    share = scores.share([True, True, False, True], [True, False, True, True])
    assert share == pytest.approx(2 / 3)
    assert scores.share([False], [True]) is None


def test_ages_are_those_of_the_moment():
    asked = numbered(*(question("what", "said", "Stop!", age) for age in (1, 6.9, 7.1, 29, 31, 89)))
    assert [scores.age_of(one, NOW) for one in asked] == [
        "0-7 days", "0-7 days", "7-30 days", "7-30 days", "30-90 days", "30-90 days"]
    rows = scores.table_of(asked, [True] * 6, [True, True, True, True, False, False], NOW)
    assert rows["what, 0-7 days"] == {"full": 2, "share": 1.0}
    assert rows["what, 30-90 days"] == {"full": 2, "share": 0.0}
    assert rows["all, all"]["share"] == pytest.approx(4 / 6)
    assert rows["where, all"] == {"full": 0, "share": None}


def test_the_best_constant_and_chance_are_told():
    said = numbered(*(question("what", "said", words) for words in ("Tea.", "Stop!", "Stop!")))
    assert scores.constant_rights(said) == [False, True, True]
    assert scores.chance_rights(said) == [0, 0.5, 0.5]
    late = numbered(*(question("when", "picked", 0) | {"time": time * SECOND, "truth": 0}
                      for time in (5, 6, 60)))
    assert scores.constant_rights(late) == [True, True, False], "the time since"
    image = numbered(question("what", "image", 3, candidates=[[0, 0]] * 16))
    assert scores.chance_rights(image) == [1 / 16]


def result_of(fading):
    table = {f"{kind}, {age}": {"full": 10, "share": 1.0} for kind in ("where", "all")
             for age in ("all",)}
    ask = {"where robot": {"questions": 10, "full": 10, "share": 1.0}}
    stores = {name: {"bytes": 10, "right": 1.0, "table": table, "by_ask": ask,
                     "by_entity": {"models": 10}}
              for name in ["full", *ninety_days.SMALL]}
    stores["fading"] = stores["fading"] | {
        "table": table | {"all, all": {"full": 10, "share": fading}}}
    return {"days": 90, "seed": 7, "recorded_bytes": 100, "quota_bytes": 10, "stores": stores}


def test_the_bar_is_reached_or_missed(capsys):
    assert ninety_days.show(result_of(0.9))
    assert "reached: 90.0 %" in capsys.readouterr().out
    assert not ninety_days.show(result_of(0.899))
    assert "MISSED: 89.9 %" in capsys.readouterr().out
    assert not ninety_days.show(result_of(None)), "the full store answers nothing"
