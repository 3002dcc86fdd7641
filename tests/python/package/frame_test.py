# SPDX-License-Identifier: Apache-2.0
"""Numbers as DataFrames, and what is said where pandas is missing."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import CAMERA, COUNT, JOINTS, SPEECH, START, Recorded, time_at

import engram
from engram.optional import MissingPackageError

pandas = pytest.importorskip("pandas")


def test_numbers_are_columns_and_times_the_index(recorded: Recorded) -> None:
    with engram.open(recorded.path) as memory:
        frame = memory[JOINTS].frame()
    assert list(frame.columns) == ["position/0", "position/1", "position/2", "load", "is_moving"]
    assert frame.shape == (COUNT, 5)
    assert frame.index.name == "time" and str(frame.index.tz) == "UTC"
    assert frame.index[3] == pandas.Timestamp(time_at(3), tz="UTC")
    np.testing.assert_allclose(frame["load"], 0.5 + 0.1 * np.arange(COUNT))
    assert frame["load"].dtype == np.float64 and frame["is_moving"].dtype == bool
    np.testing.assert_array_equal(frame["position/1"], np.sin(1 + 0.1 * np.arange(COUNT)))


def test_a_frame_is_cut_by_time(recorded: Recorded) -> None:
    with engram.open(recorded.path) as memory:
        joints = memory[JOINTS]
        assert len(joints.frame(time_at(3), time_at(5))) == 3
        assert len(joints.frame(end=START - 1)) == 0
        assert list(joints.times(time_at(3), time_at(5)).astype(np.int64)) == [
            time_at(i) for i in (3, 4, 5)
        ]


def test_texts_are_columns_and_images_are_not(recorded: Recorded) -> None:
    with engram.open(recorded.path) as memory:
        assert memory[SPEECH].frame()["speaker"].tolist() == ["Ada"]
        assert memory[CAMERA].frame().shape == (COUNT, 0)


def test_members_may_come_and_go(tmp_path: Path) -> None:
    with engram.record(tmp_path / "a.engram") as recorder:
        recorder.commit("A/B/C/d", {"x": 1, "y": [2.0, {"z": 3}]}, START)
        recorder.commit("A/B/C/d", {"x": 4, "new": True}, START + 1)
        recorder.commit("A/B/C/plain", 7.5, START)
    with engram.open(tmp_path / "a.engram") as memory:
        frame = memory["A/B/C/d"].frame()
        assert list(frame.columns) == ["x", "y/0", "y/1/z", "new"]
        assert frame["x"].tolist() == [1, 4] and np.isnan(frame["y/0"].iloc[1])
        assert memory["A/B/C/plain"].frame()["value"].tolist() == [7.5]


def test_columns_of_errors_and_curves_make_frames(learned: Recorded) -> None:
    with engram.open(learned.path) as memory:
        errors = pandas.DataFrame(memory[CAMERA].errors()).set_index("time")
        assert len(errors) == COUNT and errors["psnr_db"].min() > 10
        curve = pandas.DataFrame(memory[CAMERA].model.training_curve)
        assert curve.groupby("phase").size().sum() == len(curve)


def test_without_pandas_the_line_that_installs_it_is_named(
    recorded: Recorded, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with engram.open(recorded.path) as memory, pytest.raises(
        MissingPackageError, match="apt-get install python3-pandas"
    ):
        memory[JOINTS].frame()
