# SPDX-License-Identifier: Apache-2.0
"""Each check of a month can fail: figures that were tampered with are found."""
import copy
import pathlib
import sys
from dataclasses import replace

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3]))
from experiments.month import checks, days, report  # noqa: E402

PLAN = replace(days.PLANS["short"], nights=11)
NAMES = ("whole", "bounds", "dropped", "bytes", "models", "costs", "predictions", "catching up")


def store_of(number):
    waits = 5 if number in (PLAN.short, PLAN.killed, PLAN.full) else 0
    counts = {"bounds": 100, "within": 90, "compared": 100, "width": 5.0, "copy_width": 6.0}
    sizes = {"image_bytes": 900, "latent_bytes": 1000, "model_bytes": 500, "manifest_bytes": 100,
             "recorded_bytes": 9, "models": {days.CAMERA: 1, days.JOINTS: 1}}
    return {"recorded": {"kept": 40, "kept_joints": 40, "offered": 40},
            "predicted": {days.CAMERA: dict(counts), days.JOINTS: dict(counts)},
            "job": {"ended": "killed" if number == PLAN.killed else "well", "seconds": 3.0,
                    "processor_seconds": 3.0, "megabytes": 250.0},
            "read": {days.CAMERA: {"images": 40 * number, "dropped": 40 * max(number - 2, 0),
                                   "waiting": waits, "changed": 0, "unlike_raw": 0, "missing": 0,
                                   "min_psnr_db": 36.1},
                     days.JOINTS: {"rows": 40 * number, "waiting": 0, "missing": 0,
                                   "max_error": 0.001}},
            "damage": [], "sizes": sizes}


@pytest.fixture
def month():
    return [{"night": number, "stores": {name: store_of(number) for name in ("auto", "video")}}
            for number in range(1, PLAN.nights + 1)]


def missed(figures):
    return [NAMES[one.number] for one in checks.judge(PLAN, figures) if one.held is False]


def camera_of(month, number, name="auto"):
    return month[number - 1]["stores"][name]["read"][days.CAMERA]


def test_a_good_month_holds(month):
    assert [one.held for one in checks.judge(PLAN, month)] == [True] * 8


def test_a_month_that_began_is_not_judged_on_what_is_to_come(month):
    held = {one.number: one.held for one in checks.judge(PLAN, month[:1])}
    assert held == {0: True, 1: True, 2: None, 3: None, 4: True, 5: None, 6: None, 7: None}


def test_damage_is_found(month):
    month[3]["stores"]["video"]["damage"] = ["segment 3: checksum"]
    assert missed(month) == ["whole"]


def test_a_night_that_was_not_killed_is_found(month):
    month[PLAN.killed - 1]["stores"]["auto"]["job"]["ended"] = "with 0"
    assert missed(month) == ["whole"]


@pytest.mark.parametrize("key, value", [("min_psnr_db", 35.99), ("unlike_raw", 1), ("missing", 1),
                                        ("images", 399)])
def test_an_image_that_is_worse_other_or_gone_is_found(month, key, value):
    camera_of(month, 10)[key] = value
    assert missed(month) == ["bounds"]


@pytest.mark.parametrize("key, value", [("max_error", 0.00101), ("rows", 439), ("missing", 1)])
def test_joints_that_are_wrong_or_gone_are_found(month, key, value):
    month[10]["stores"]["video"]["read"][days.JOINTS][key] = value
    assert missed(month) == ["bounds"]


def test_a_change_of_what_was_dropped_is_found(month):
    camera_of(month, 9, "video")["changed"] = 1
    assert missed(month) == ["dropped"]


@pytest.mark.parametrize("key, more", [("latent_bytes", 40), ("model_bytes", 40),
                                       ("manifest_bytes", 40), ("image_bytes", 20)])
def test_bytes_beyond_video_alone_are_found(month, key, more):
    month[PLAN.bytes_from - 2]["stores"]["auto"]["sizes"][key] += more
    assert not missed(month), "that night is too early to count"
    month[PLAN.bytes_from - 1]["stores"]["auto"]["sizes"][key] += more
    assert missed(month) == ["bytes"]


def test_a_model_too_many_is_found(month):
    allowed = 1 + PLAN.changes_until(PLAN.moved)
    for night in month[PLAN.moved - 1 :]:
        night["stores"]["video"]["sizes"]["models"][days.JOINTS] = allowed
    assert not missed(month)
    month[PLAN.moved - 2]["stores"]["video"]["sizes"]["models"][days.JOINTS] = allowed
    assert missed(month) == ["models"]


@pytest.mark.parametrize("key", ["processor_seconds", "megabytes"])
def test_a_night_that_costs_more_and_more_is_found(month, key):
    month[PLAN.late - 1]["stores"]["auto"]["job"][key] *= 1.21
    assert missed(month) == ["costs"]


@pytest.mark.parametrize("key, value", [("within", 86), ("within", 96), ("bounds", 0),
                                        ("width", 6.01)])
def test_bounds_that_lie_or_say_nothing_are_found(month, key, value):
    month[4]["stores"]["auto"]["predicted"][days.JOINTS][key] = value
    assert missed(month) == ["predictions"]


def test_a_backlog_that_stays_is_found(month):
    for number in range(PLAN.short, PLAN.short + 4):
        camera_of(month, number)["waiting"] = 1
    assert missed(month) == ["catching up"]


def test_a_short_night_that_was_long_enough_is_found(month):
    camera_of(month, PLAN.short)["waiting"] = 0
    assert missed(month) == ["catching up"]


def test_what_was_missed_is_told(month):
    camera_of(month, 10)["min_psnr_db"] = 20.0
    lines = report.verdict_lines(checks.judge(PLAN, month))
    (place,) = [line for line in lines if line.startswith("  ")]
    assert place.split() == ["night", "10,", "auto:", "an", "image", "with", "20.00", "dB"]
    worse = copy.deepcopy(month)
    worse[2]["stores"]["auto"]["damage"] = [str(one) for one in range(99)]
    assert "           and 87 more" in report.verdict_lines(checks.judge(PLAN, worse))
