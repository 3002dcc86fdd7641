# SPDX-License-Identifier: Apache-2.0
"""Nights that are too short are judged. Tiny ones run where $ENGRAM names the program."""

import json
import os
import pathlib
import subprocess
import sys

import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[3] / "experiments" / "learning"
ENGRAM = os.environ.get("ENGRAM", "")
sys.path.insert(0, str(FOLDER))
import short_nights  # noqa: E402


def night(number, seconds, waits, share=0.5, encoded=7):
    is_done = waits == 0
    return {"share": share, "night": number, "budget_seconds": 50.0, "seconds": seconds,
            "encoded": encoded,
            "waiting": {"a/b/c/d": waits}, "is_done": is_done, "notes": [],
            "of_whole": {"a/b/c/d": 1.02} if is_done else None}


def judged(*nights):
    return short_nights.show({"whole_seconds": 100.0, "nights": list(nights)})


def test_nights_are_judged(capsys):
    assert judged(night(1, 51.0, 40), night(2, 49.0, 0))
    assert "reached" in capsys.readouterr().out
    assert not judged(night(1, 81.0, 0)), "31 s late"
    assert not judged(night(1, 50.0, 40, encoded=0), night(2, 49.0, 0)), "it did nothing"
    assert not judged(night(1, 50.0, 9), night(2, 50.0, 8), night(3, 50.0, 1), night(4, 9.0, 0))
    assert judged(night(3, 50.0, 1, share=0.25), night(4, 50.0, 0, share=0.25))


@pytest.mark.skipif(not ENGRAM, reason="needs $ENGRAM")
def test_a_short_night_leaves_the_rest_for_the_next(tmp_path):
    found = tmp_path / "found.json"
    subprocess.run([sys.executable, FOLDER / "short_nights.py", ENGRAM, "", "--images", "64", "16",
                    "--shares", "0.5", "--max-nights", "12", "--work", tmp_path, "--json", found],
                   check=False, timeout=900)
    nights = json.loads(found.read_text())["nights"]
    assert nights[-1]["is_done"]
    # Each image once: what a night did is not done again. How many bytes that takes depends on how
    # quick the machine is just now.
    assert sorted(nights[-1]["rows"].values()) == [16, 64]
