# SPDX-License-Identifier: Apache-2.0
"""What was measured is kept, and measured anew when what it was measured with changes."""

import argparse
import json
import pathlib

import pytest

from experiments.paper.measuring import Measuring


@pytest.fixture
def make(tmp_path: pathlib.Path):
    def measuring(minutes: float = 1, again: bool = False) -> Measuring:
        return Measuring("transfer", argparse.Namespace(
            engram=tmp_path / "engram", programs=tmp_path, recordings="", profile="short",
            work=tmp_path, again=again, minutes=minutes, networks_from=None))

    return measuring


def test_a_result_is_used_again_for_the_same_inputs_only(make):
    assert make().measured("a", {"budget": 1}, lambda: [1]) == [1]
    assert make().measured("a", {"budget": 1}, lambda: [2]) == [1]
    assert make().measured("a", {"budget": 2}, lambda: [3]) == [3]
    assert make(again=True).measured("a", {"budget": 2}, lambda: [4]) == [4]


def test_a_result_whose_file_is_gone_is_measured_anew(make, tmp_path):
    file = tmp_path / "picture"
    file.touch()
    assert make().measured("a", {}, lambda: str(file), lambda value: [value]) == str(file)
    file.unlink()
    assert make().measured("a", {}, lambda: "new", lambda value: [value]) == "new"


def test_what_there_was_no_time_for_is_none_and_named(make):
    measuring = make(minutes=0)
    assert measuring.measured("a", {}, lambda: 1) is None
    assert measuring.skipped == ["a"]
    assert not measuring.file.exists()


def test_results_survive_as_json_with_their_inputs(make):
    measuring = make()
    measuring.measured("a", {"seed": 7}, lambda: 1.5)
    kept = json.loads(measuring.file.read_text())["a"]
    assert (kept["value"], kept["inputs"]) == (1.5, {"seed": 7})


def test_a_program_that_fails_ends_the_experiment_and_is_named(make, tmp_path):
    program = tmp_path / "fails"
    program.write_text("#!/bin/sh\nexit 3\n")
    program.chmod(0o755)
    with pytest.raises(SystemExit, match="fails.*ended with 3"):
        make().program("fails")
