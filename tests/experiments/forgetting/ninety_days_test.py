# SPDX-License-Identifier: Apache-2.0
"""Three short days are recorded, fade and are asked. Runs where $ENGRAM names the program."""

import json
import os
import pathlib
import subprocess
import sys

import pytest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "experiments/forgetting/ninety_days.py"
ENGRAM = os.environ.get("ENGRAM", "")


@pytest.mark.skipif(not ENGRAM, reason="needs $ENGRAM")
def test_three_days_fade_and_answer(tmp_path):
    found = tmp_path / "found.json"
    done = subprocess.run(
        [sys.executable, "-B", SCRIPT, ENGRAM, "--days", "3", "--seconds", "8", "--questions", "90",
         "--share", "0.6", "--steps", "20", "--min-snapshots", "50", "--verify", "1",
         "--json", found], check=False, timeout=900, capture_output=True, text=True)
    assert found.exists(), done.stderr
    result = json.loads(found.read_text())
    stores = result["stores"]
    assert stores["full"]["right"] > 0.97
    shares = {name: one["table"]["all, all"]["share"] for name, one in stores.items()}
    for name in ("fading", "oldest", "empty"):
        assert stores[name]["bytes"] <= result["quota_bytes"]
    assert shares["empty"] == 0
    # In three days models take nearly all of the quota, so little more can be said.
    assert shares["fading"] > shares["oldest"]
    assert done.returncode == (0 if shares["fading"] >= 0.9 else 1)
    assert ("reached" if done.returncode == 0 else "MISSED") in done.stdout


def test_what_was_half_made_is_made_again(tmp_path):
    sys.path.insert(0, str(SCRIPT.parent))
    import ninety_days

    def killed(part):
        part.mkdir()
        (part / "first").write_text("a day")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ninety_days.made_whole(tmp_path / "store", killed)
    assert not (tmp_path / "store").exists()
    ninety_days.made_whole(tmp_path / "store", lambda part: part.mkdir())
    assert not list((tmp_path / "store").iterdir())
    ninety_days.made_whole(tmp_path / "store", killed)  # It is there: nothing is made.
