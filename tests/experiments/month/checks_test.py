# SPDX-License-Identifier: Apache-2.0
"""Every check of a month holds where all is well, and is missed where it is not."""

import copy

import pytest

from experiments.month import checks, days, report

PLAN = days.PLANS["test"]


def store_of(number):
    """Figures of a store after a night in which all went well."""
    kept = number * 40
    counts = {"predictions": 100, "bounds": 100, "within": 91, "compared": 100, "width": 90.0,
              "copy_width": 100.0}
    is_cut = number in (PLAN.killed, PLAN.short, PLAN.full)
    ended = {PLAN.killed: "killed", PLAN.full: "with 1"}.get(number, "well")
    return {
        "recorded": {"offered": 40, "kept": 40, "kept_joints": 40},
        "predicted": {days.CAMERA: dict(counts), days.JOINTS: dict(counts)},
        "job": {"seconds": 9.0, "processor_seconds": 10.0, "megabytes": 200.0, "ended": ended,
                "entities": {}},
        "read": {days.CAMERA: {"images": kept, "dropped": max(0, kept - 80), "encoded": kept,
                               "waiting": 40 if is_cut else 0, "changed": 0, "unlike_raw": 0,
                               "missing": 0, "forms": {"video": kept}, "min_psnr_db": 36.1},
                 days.JOINTS: {"rows": kept, "dropped": 0, "waiting": 0, "missing": 0,
                               "max_error": 0.001}},
        "damage": [],
        "sizes": {"latent_bytes": 1000 * number, "recorded_bytes": 5000, "model_bytes": 5000,
                  "manifest_bytes": 500, "models": {days.CAMERA: 1, days.JOINTS: 1},
                  "image_bytes": 900 * number}}


def figures_of(nights=PLAN.nights):
    return [{"night": number, "happenings": PLAN.happenings(number),
             "stores": {"auto": store_of(number), "video": store_of(number)}}
            for number in range(1, nights + 1)]


@pytest.fixture
def figures():
    return figures_of()


def missed(figures):
    """Numbers of the checks that were missed."""
    return [one.number for one in checks.judge(PLAN, figures) if one.held is False]


def auto(figures, number):
    return figures[number - 1]["stores"]["auto"]


def test_all_hold_where_all_is_well(figures):
    assert all(one.held is True and not one.missed for one in checks.judge(PLAN, figures))
    assert [one.number for one in checks.judge(PLAN, figures)] == list(range(8))


def test_a_short_month_is_not_judged_by_what_it_has_not_seen():
    verdicts = checks.judge(PLAN, figures_of(1))
    assert [one.held for one in verdicts] == [True, True, None, None, True, None, None, None]


def test_damage_is_found(figures):
    auto(figures, 3)["damage"] = ["segment 4: checksum"]
    assert missed(figures) == [0]


@pytest.mark.parametrize("number, ended", [(PLAN.killed, "well"), (PLAN.full, "well"),
                                           (PLAN.full, "with -11"), (3, "with -6")])
def test_a_night_that_ends_otherwise_than_planned_is_found(figures, number, ended):
    auto(figures, number)["job"]["ended"] = ended
    assert missed(figures) == [0]


@pytest.mark.parametrize("entity, key, value", [
    (days.CAMERA, "min_psnr_db", 35.99), (days.CAMERA, "unlike_raw", 1), (days.CAMERA, "missing", 1),
    (days.CAMERA, "images", 119), (days.JOINTS, "max_error", 0.00101), (days.JOINTS, "rows", 119),
    (days.JOINTS, "missing", 1)])
def test_an_image_below_its_bound_or_lost_is_found(figures, entity, key, value):
    auto(figures, 3)["read"][entity][key] = value
    assert missed(figures) == [1]


def test_a_dropped_image_that_changes_is_found(figures):
    auto(figures, 7)["read"][days.CAMERA]["changed"] = 1
    assert missed(figures) == [2]


@pytest.mark.parametrize("kind", ["latent_bytes", "model_bytes", "manifest_bytes",
                                  "image_bytes"])
def test_too_many_bytes_are_found(figures, kind):
    auto(figures, 8)["sizes"][kind] += 0.03 * checks.kept_bytes(auto(figures, 8))
    assert missed(figures) == [3]


def test_bytes_of_early_nights_do_not_count(figures):
    auto(figures, PLAN.bytes_from - 1)["sizes"]["latent_bytes"] *= 2
    assert not missed(figures)


def test_models_are_counted_beside_changes_of_the_scene(figures):
    auto(figures, 5)["sizes"]["models"][days.JOINTS] = 2
    assert not missed(figures), "the room of day 5 is new"
    auto(figures, 4)["sizes"]["models"][days.JOINTS] = 2
    assert missed(figures) == [4]


@pytest.mark.parametrize("key", ["processor_seconds", "megabytes"])
def test_a_late_night_that_costs_more_is_found(figures, key):
    auto(figures, PLAN.late)["job"][key] *= 1.19
    assert not missed(figures)
    auto(figures, PLAN.late)["job"][key] *= 1.02
    assert missed(figures) == [5]


@pytest.mark.parametrize("changes", [{"within": 86}, {"within": 96}, {"width": 101.0},
                                     {"bounds": 0, "within": 0}])
@pytest.mark.parametrize("entity", [days.CAMERA, days.JOINTS])
def test_bounds_that_hold_too_rarely_too_often_or_are_too_wide_are_found(figures, entity, changes):
    auto(figures, 4)["predicted"][entity].update(changes)
    assert missed(figures) == [6]


def test_bounds_of_the_first_day_do_not_count(figures):
    auto(figures, 1)["predicted"][days.CAMERA]["within"] = 0
    assert not missed(figures)


def test_shares_of_all_days_together_are_told(figures):
    auto(figures, 4)["predicted"][days.CAMERA]["within"] = 75
    found = checks.predictions_bounded(PLAN, figures).found
    assert "auto images 89.0 % of all days together, 0.90 as wide, 7 of 8 days inside" in found


def test_what_waits_has_three_nights(figures):
    for number in (5, 6):
        auto(figures, number)["read"][days.CAMERA]["waiting"] = 40
    assert not missed(figures)
    auto(figures, 7)["read"][days.CAMERA]["waiting"] = 40
    assert missed(figures) == [7]


@pytest.mark.parametrize("number", [PLAN.killed, PLAN.short, PLAN.full])
def test_a_night_that_was_to_be_cut_short_and_was_not_is_found(figures, number):
    auto(figures, number)["read"][days.CAMERA]["waiting"] = 0
    assert missed(figures) == [7]


def test_judging_leaves_figures_as_they_are(figures):
    before = copy.deepcopy(figures)
    checks.judge(PLAN, figures)
    assert figures == before


def test_what_was_missed_is_shown_and_written(figures, tmp_path):
    auto(figures, 7)["read"][days.CAMERA]["changed"] = 1
    lines = report.verdict_lines(checks.judge(PLAN, figures))
    assert lines[2].startswith("2  MISSED") and "night 7, auto: 1 of 200 images" in lines[3]
    rows = report.night_table(PLAN, figures).splitlines()
    assert len(rows) == 1 + 2 * PLAN.nights and rows[3].endswith("killed")
    report.write_json(PLAN, figures, tmp_path / "month.json", {"form": "test"})
    assert '"held": false' in (tmp_path / "month.json").read_text()
