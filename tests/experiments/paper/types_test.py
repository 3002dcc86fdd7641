# SPDX-License-Identifier: Apache-2.0
"""Types of the experiments are those that they say."""

import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[3]


def test_mypy_finds_nothing(tmp_path: pathlib.Path):
    packages = [word for name in ("paper", "storage", "loocv", "transfer")
                for word in ("-p", f"experiments.{name}")]
    done = subprocess.run(
        ["mypy", "--strict", "--ignore-missing-imports", "--cache-dir", tmp_path, *packages],
        cwd=ROOT, env={**os.environ, "MYPYPATH": str(ROOT), "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 0, done.stdout
