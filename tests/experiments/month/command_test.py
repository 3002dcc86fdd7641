# SPDX-License-Identifier: Apache-2.0
"""What the command of a month takes, and how it goes on."""

import json
import pathlib
import subprocess
import sys

import pytest

from checks_test import figures_of
from experiments.month import __main__ as month
from experiments.month import program

ROOT = pathlib.Path(__file__).resolve().parents[3]


def options(tmp_path, *words):
    return month.arguments_of(["--engram", sys.executable, "--form", "test", "--work",
                               str(tmp_path), *words])


@pytest.mark.parametrize("words", [["--nights", "0"], ["--images", "15"], ["--checks", "8"],
                                   ["--engram", "/no/such/program"], ["--form", "long"]])
def test_what_makes_no_sense_is_refused(tmp_path, words, capsys):
    with pytest.raises(SystemExit):
        options(tmp_path, *words)
    assert words[0] in capsys.readouterr().err


def test_a_month_goes_on_where_it_was_unless_its_plan_is_another(tmp_path):
    first = month.Month(options(tmp_path))
    assert first.done == 0 and first.end == 9
    folder = first.night_folder(3)
    folder.mkdir()
    (folder / "figures.json").write_text(json.dumps(figures_of(3)))
    again = month.Month(options(tmp_path, "--nights", "5"))
    assert again.done == 3 and again.end == 5 and len(again.figures) == 3
    # Nights 2 (killed) and 3 (calm) are no measure.
    assert again.usual_seconds("auto") == 0
    with pytest.raises(program.Failed, match="another plan"):
        month.Month(options(tmp_path, "--images", "50"))
    assert month.Month(options(tmp_path, "--images", "50", "--anew")).done == 0


def test_named_checks_decide_and_have_to_be_judged(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(program, "run", lambda words: program.Ended(0, "engram 0", "", 0, 0))
    monkeypatch.setattr(month.report, "draw", lambda *_: None)
    lived = month.Month(options(tmp_path))
    lived.figures = figures_of()
    lived.figures[8]["stores"]["auto"]["job"]["megabytes"] *= 2
    assert not month.show(lived, options(tmp_path))
    assert month.show(lived, options(tmp_path, "--checks", "0", "1", "2", "7"))
    assert not month.show(lived, options(tmp_path, "--checks", "5"))
    lived.figures = figures_of(1)
    assert month.show(lived, options(tmp_path))
    assert not month.show(lived, options(tmp_path, "--checks", "2")), "nothing was dropped yet"
    assert "5  MISSED" in capsys.readouterr().out


def test_types_are_those_that_they_say(tmp_path):
    done = subprocess.run(
        ["mypy", "--strict", "--ignore-missing-imports", "--cache-dir", tmp_path, "-p",
         "experiments.month"], cwd=ROOT, env={"PATH": "/usr/bin:/bin", "MYPYPATH": str(ROOT)},
        stdout=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 0, done.stdout
