# SPDX-License-Identifier: Apache-2.0
"""A small month is lived, stopped in its midst, and goes on. $ENGRAM is the program.

What nights cost, how many bytes and models a few small images come to, and how many of a hundred
bounds hold is measured and not judged here: the first depends on the machine, the others are
promises about longer days. The full form judges them.
"""
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
ENGRAM = os.environ.get("ENGRAM", "")
STORES_ARE_TRUE = ("0", "1", "2", "7")
NIGHTS = 9


def month(work, *more):
    """The words of the program, and its environment."""
    paths = [str(ROOT), os.environ.get("PYTHONPATH", "")]
    return {"args": [sys.executable, "-m", "experiments.month", "--form", "test", "--engram",
                     ENGRAM, "--work", work, *more],
            "env": {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))}}


def stop_after_the_first_night(work):
    process = subprocess.Popen(**month(work), stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    while not (work / "test" / "01").exists() and process.poll() is None:
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    _, told = process.communicate(timeout=300)
    assert process.returncode == 130, told.decode()
    assert b"the same command goes on" in told


@pytest.mark.skipif(not ENGRAM, reason="$ENGRAM names no program")
def test_a_small_month_is_lived(tmp_path):
    stop_after_the_first_night(tmp_path)
    done = subprocess.run(**month(tmp_path, "--checks", *STORES_ARE_TRUE), capture_output=True,
                          text=True)
    print(done.stdout)  # Pytest shows it where something is wrong.
    assert done.returncode == 0, done.stderr
    assert "goes on after night" in done.stderr and f"night 1 of {NIGHTS}" not in done.stderr
    found = json.loads((tmp_path / "month-test.json").read_text())
    assert [night["night"] for night in found["nights"]] == list(range(1, NIGHTS + 1))
    assert all(check["held"] is not None for check in found["checks"]), "each was measured"
    last = found["nights"][-1]["stores"]
    for store in last.values():
        camera = store["read"]["Vision/RGB/head/cam"]
        assert camera["dropped"] > camera["images"] / 4
        assert camera["encoded"] == camera["images"]
    assert (tmp_path / "month-test.png").stat().st_size > 10_000


@pytest.mark.skipif(not ENGRAM, reason="$ENGRAM names no program")
def test_wrong_options_are_refused(tmp_path):
    for wrong in (["--nights", "0"], ["--images", "8"], ["--engram", tmp_path / "none"]):
        done = subprocess.run(**month(tmp_path, *wrong), capture_output=True, text=True)
        assert done.returncode == 2 and wrong[0] in done.stderr
