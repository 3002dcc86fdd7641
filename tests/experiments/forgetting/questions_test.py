# SPDX-License-Identifier: Apache-2.0
"""Questions of a seed are always the same, and what happened answers them."""

import pathlib
import sys

import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[3] / "experiments" / "forgetting"
sys.path.insert(0, str(FOLDER))
import days  # noqa: E402
import questions  # noqa: E402

SECOND = days.SECOND


def truth_of_day(day):
    """A tea box stands for 3 s, is picked up within 2 s, carried out of sight, held until 9 s."""
    begin = (day + 1) * 86_400 * SECOND

    def view(second, x, is_visible, held_by):
        return {"time": begin + second * SECOND, "position": [x, float(day), 1.0],
                "is_visible": is_visible, "held_by": held_by}

    return {
        "objects": {"tea_box": [view(0, 0.0, True, ""), view(3, 0.0, True, "right"),
                                view(5, 0.2, False, "right"), view(9, 0.4, False, "right")]},
        "actions": [{"time": begin + 5 * SECOND, "skill": "pick", "started": begin + 3 * SECOND,
                     "ended": begin + 5 * SECOND, "outcome": 1, "object": "tea_box"}],
        "platform": [{"time": begin + second * SECOND, "position": [float(second), 0.0]}
                     for second in range(11)],
        "speech": [{"time": begin + SECOND, "text": f"Bring the tea, {day % 2}."}],
        "image_times": [begin + i * SECOND for i in range(11)]}


@pytest.fixture
def truths():
    return [truth_of_day(day) for day in range(4)]


def test_questions_of_a_seed_are_the_same_again(truths):
    first = questions.Maker(truths, 3).make(60)
    assert first == questions.Maker(truths, 3).make(60)
    assert first != questions.Maker(truths, 4).make(60)
    assert [one["number"] for one in first] == list(range(60))
    assert {kind: sum(one["kind"] == kind for one in first) for kind in questions.ASKS} == {
        "where": 20, "when": 20, "what": 20}


def test_what_happened_answers(truths):
    for one in questions.Maker(truths, 3).make(300):
        day, truth = truths[one["day"]], one["truth"]
        begin = day["image_times"][0]
        since = one["time"] - begin
        assert one["moment"] <= one["time"]
        if one["ask"] == "robot":
            assert truth == pytest.approx([since / SECOND, 0])
        elif one["ask"] == "object":
            expected = 0.0 if since < 5 * SECOND else 0.2 if since < 9 * SECOND else 0.4
            assert truth == [expected, one["day"], 1.0]
        elif one["ask"] == "picked":
            assert truth == one["moment"] == begin + 5 * SECOND
            assert one["day"] == 3 or one["time"] < begin + 86_405 * SECOND, "before the next one"
        elif one["ask"] == "seen":
            assert truth == begin + 3 * SECOND
            assert one["day"] == 3 or one["time"] < begin + 86_400 * SECOND
        elif one["ask"] == "image":
            assert one["candidates"][truth] == (one["day"], since // SECOND)
            assert len(set(one["candidates"])) == questions.CHOICES
            assert sum(other == one["day"] for other, _ in one["candidates"]) == (
                1 + questions.SAME_DAY)
        elif one["ask"] == "held":
            assert truth == "tea_box" and 3 * SECOND < since < 9 * SECOND
        elif one["ask"] == "doing":
            assert truth == ["pick", "tea_box"] and 3 * SECOND < since < 5 * SECOND
        elif one["kind"] == "what":
            assert truth == f"Bring the tea, {one['day'] % 2}."
        else:
            assert one["ask"] == "said" and truth == begin + SECOND


def test_days_count_back_from_today():
    import datetime

    plan = days.Plan(days=90, seed=7, seconds=12, today=datetime.date(2026, 11, 26))
    ages = [(plan.now - plan.start_of(day)) / (86_400 * SECOND) for day in range(90)]
    assert all(89 - day < age < 90 - day for day, age in enumerate(ages))
    assert len({plan.seed_of(day) for day in range(90)}) == 90


def test_values_of_plain_files_lose_the_marks_of_their_types():
    assert days.plain_value({"$ndarray": {"data": [1, 2], "shape": [2]}}) == [1, 2]
    assert days.plain_value({"time": {"$int64": "12"}, "x": [{"$float": 0.5}]}) == {
        "time": 12, "x": [0.5]}
