# SPDX-License-Identifier: Apache-2.0
"""Days are as the plan of a month wants them."""

import numpy as np
import pytest

from experiments.month import days

NAMES = ["a new room", "camera moved", "calm", "event-driven", "10 times as long", "killed",
         "far too short", "full disk"]


@pytest.mark.parametrize("form", days.PLANS)
def test_every_form_has_all_happenings_each_in_time_to_be_judged(form):
    plan = days.PLANS[form]
    told = [name for day in range(1, plan.nights + 1) for name in plan.happenings(day)]
    assert set(told) == set(NAMES)
    assert all(told.count(name) == 1 for name in NAMES[1:])
    for night in (plan.killed, plan.short, plan.full):
        assert night < plan.nights and plan.happenings(night + 1) not in (
            ["killed"], ["far too short"], ["full disk"])
    assert plan.late <= plan.nights and plan.is_usual(plan.early) and plan.is_usual(plan.late)


def test_the_full_month_is_the_one_that_was_asked_for():
    plan = days.PLANS["full"]
    assert (plan.nights, plan.images, plan.bytes_from) == (30, 300, 10)
    assert (plan.early, plan.late) == (5, 30)
    assert list(plan.rooms) == [1, 10, 20] and plan.moved == 15
    assert plan.images_of(plan.long) == 3000
    assert [plan.changes_until(day) for day in (9, 10, 15, 20, 30)] == [0, 1, 2, 3, 3]


@pytest.mark.parametrize("form", days.PLANS)
def test_days_of_a_room_show_what_no_other_day_does(form):
    plan = days.PLANS[form]
    for room in plan.rooms:
        shown = set()
        for day in (day for day in range(room, plan.nights + 1) if plan.room_of(day) == room):
            rows = set(days.drawn_rows(plan, day).tolist())
            assert not rows & shown
            shown |= rows
        assert max(shown) < days.drawn_seconds(plan, room) * days.DRAWN_HZ


def test_nothing_moves_on_the_calm_day_and_now_and_then_on_the_event_driven_one():
    plan = days.PLANS["short"]
    assert set(np.diff(days.drawn_rows(plan, plan.calm))) == {0}
    steps = np.diff(days.drawn_rows(plan, plan.events))
    assert set(steps) == {0, 1} and 0.5 < (steps == 0).mean() < 0.8


def test_the_camera_sees_something_else_once_it_was_moved():
    plan = days.PLANS["full"]
    drawn = np.tile(np.arange(days.DRAWN_SIDE, dtype=np.uint8)[:, None, None],
                    (1, days.DRAWN_SIDE, 3))
    before, after = (days.seen(plan, day, drawn) for day in (plan.moved - 1, plan.moved))
    assert before.shape == after.shape == (plan.side, plan.side, 3)
    assert before[0, 0, 0] == 8 and after[0, 0, 0] == 8
    assert before[-1, 0, 0] == 119 and after[-1, 0, 0] == 103


def test_light_drifts_from_night_to_night():
    lights = [days.light_of(day) for day in range(1, 31)]
    assert all(0.75 < gain < 1.06 for light in lights for gain in light)
    assert min(np.abs(one - other).max() for one, other in zip(lights, lights[1:])) > 0.005


def test_an_image_is_the_same_whenever_it_is_made():
    plan = days.PLANS["test"]
    drawn = np.full((days.DRAWN_SIDE, days.DRAWN_SIDE, 3), 100, np.uint8)
    one, other = (days.photographed(plan, 3, 7, drawn) for _ in range(2))
    assert np.array_equal(one, other)
    assert not np.array_equal(one, days.photographed(plan, 3, 8, drawn)), "noise differs"


def test_a_day_is_kept_and_its_moments_are_of_it(tmp_path):
    times = days.begin_of(4) + days.STEP_NS * np.arange(5)
    day = days.RawDay(times, np.zeros((5, 2, 2, 3), np.uint8), np.ones((5, 3), np.float32))
    day.save(days.file_of(tmp_path, 4))
    again = days.RawDay.load(days.file_of(tmp_path, 4))
    assert again.places[int(times[3])] == 3 and np.array_equal(again.joints, day.joints)
    assert {days.day_of(int(time)) for time in times} == {4}
    assert [file.name for file in tmp_path.iterdir()] == ["day-04.npz"]
