# SPDX-License-Identifier: Apache-2.0
"""What a night costs is measured and judged. A tiny night runs where $ENGRAM names the program."""

import importlib.util
import json
import os
import pathlib
import subprocess
import sys

import pytest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "experiments" / "learning" / "night_bars.py"
ENGRAM = os.environ.get("ENGRAM", "")


@pytest.fixture
def bars():
    spec = importlib.util.spec_from_file_location("night_bars", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def night(video, **more):
    stages = {"samples": 3.0, "video": video, "start": 1.0}
    return {"processor_seconds": sum(stages.values()), "stages": stages, "megabytes": 500,
            "bytes_an_image": 300,
            "encodes": {"images": 100, "mean_per_search": 3.75, "median_per_search": 3,
                        "known_videos": 2, "video": "av1:effort=6"}, **more}


def result_of(bars, *nights):
    return {"sizes": [{"size": "128x128", "images": 100, "nights": list(nights),
                       "day_core_seconds": bars.day_seconds(nights[0], 100)}]}


def test_a_day_pays_for_samples_and_the_start_once_a_camera(bars):
    assert bars.day_seconds(night(5.0), 100) == pytest.approx(2 * 4 + 0.05 * 288_000)


def test_bars_are_judged(bars):
    lines, is_reached = bars.verdicts(result_of(bars, night(5.0), night(6.0)))
    assert is_reached and len(lines) == 4
    for nights in ([night(8.0)], [night(5.0), night(9.0)], [night(5.0, megabytes=1501)]):
        lines, is_reached = bars.verdicts(result_of(bars, *nights))
        assert not is_reached and sum("MISSED" in line for line in lines) == 1


def test_tables_have_a_row_for_each_night(bars):
    result = result_of(bars, night(5.0), night(6.0))
    assert bars.stage_table(result).splitlines()[2].split() == [
        "128x128", "2", "30.0", "60.0", "10.0", "100.0"]
    assert bars.night_table(result).splitlines()[1].split()[:6] == [
        "128x128", "1", "100", "100", "2", "3.75"]


def test_each_image_of_a_recording_is_taken_once(bars):
    recordings = object.__new__(bars.Recordings)
    recordings.videos, recordings.lengths = ["a", "b", "c"], [10, 4, 10]
    assert list(recordings.pieces(0, 8)) == [("a", 0, 8)]
    assert list(recordings.pieces(8, 8)) == [("a", 8, 2), ("b", 0, 4), ("c", 0, 2)]
    assert list(recordings.pieces(16, 8)) == [("c", 2, 8)]


def test_wrong_options_are_refused(bars, capsys):
    for wrong in (["--images", "8"], ["--images", "16", "16"], ["--sizes", "128"],
                  ["--nights", "0"]):
        with pytest.raises(SystemExit):
            bars.arguments_of([sys.executable, "", *wrong])
        assert "needs" in capsys.readouterr().err


@pytest.mark.skipif(not ENGRAM, reason="$ENGRAM names no program")
def test_two_tiny_nights_are_measured(tmp_path):
    done = subprocess.run(
        [SCRIPT, ENGRAM, "", "--sizes", "64x64", "--images", "16", "--nights", "2",
         "--representation", "video", "--json", tmp_path / "bars.json", "--work", tmp_path],
        capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    assert "night 2 of 2" in done.stderr and "processor time for each new image" in done.stdout
    (size,) = json.loads((tmp_path / "bars.json").read_text())["sizes"]
    for one in size["nights"]:
        assert one["psnr_minimum_db"] >= 35
        assert one["encodes"]["images"] >= 16
        assert one["encodes"]["mean_per_search"] >= 1
        assert sum(one["stages"].values()) == pytest.approx(one["processor_seconds"], rel=0.05)
        assert one["stages"]["video"] > 0 and one["stages"]["training"] >= 0
    assert [file.name for file in tmp_path.iterdir()] == ["bars.json"]
