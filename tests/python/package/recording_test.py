# SPDX-License-Identifier: Apache-2.0
"""Committing from Python."""

from __future__ import annotations

import datetime
import threading
from pathlib import Path

import numpy as np
import pytest
from conftest import CAMERA, COUNT, JOINTS, SPEECH, START, Recorded, image_at

import engram
from engram import errors


def test_what_is_committed_is_there(recorded: Recorded) -> None:
    with engram.open(recorded.path) as memory:
        assert memory.entities == [JOINTS, SPEECH, CAMERA]
        np.testing.assert_array_equal(
            np.stack([one.image for one in memory[CAMERA]]), recorded.images
        )
        assert [one.time for one in memory[JOINTS]] == recorded.times
        assert memory[SPEECH].latest()[0].value == {"text": "Bring me the salt", "speaker": "Ada"}
        value = memory[JOINTS].at(START).value
        assert isinstance(value["load"], np.float64) and value["is_moving"] is True


def test_committed_arrays_are_copies(tmp_path: Path) -> None:
    image = image_at(0)
    with engram.record(tmp_path / "a.engram") as recorder:
        recorder.commit(CAMERA, image, START)
        image[:] = 0
    with engram.open(tmp_path / "a.engram") as memory:
        np.testing.assert_array_equal(memory[CAMERA].at(START).image, image_at(0))


def test_a_commit_survives_without_close_and_is_seen_after_refresh(tmp_path: Path) -> None:
    path = tmp_path / "a.engram"
    recorder = engram.record(path)
    recorder.commit(JOINTS, {"x": 1.0}, START)
    with engram.open(path) as memory:
        assert len(memory[JOINTS]) == 1
        recorder.commit(JOINTS, {"x": 2.0}, START + 1)
        assert len(memory[JOINTS]) == 1
        memory.refresh()
        assert [one.value["x"] for one in memory[JOINTS]] == [1.0, 2.0]
    recorder.close()


def test_filters_of_a_config_count_what_they_drop(tmp_path: Path) -> None:
    config = tmp_path / "recording.yaml"
    config.write_text("entities:\n  - match: Vision/.*\n    filters: [{frequency: {rate: 1Hz}}]\n")
    with engram.record(tmp_path / "a.engram", config=config) as recorder:
        for i in range(20):
            recorder.commit(CAMERA, image_at(i), START + i * 100_000_000)
        counts = recorder.counts[CAMERA]
        kept = counts["kept"]
        assert counts["offered"] == 20 and 2 <= kept <= 3
        assert counts["dropped_by"] == {"frequency": 20 - kept}
    assert recorder.counts[CAMERA]["kept"] == kept, "they outlive the session"
    assert f"{kept} kept of 20" in repr(recorder)


def test_a_preset_is_taken_by_name(tmp_path: Path) -> None:
    with engram.record(tmp_path / "a.engram", preset="small") as recorder:
        recorder.commit(CAMERA, image_at(1), START)
    with engram.open(tmp_path / "a.engram") as memory:
        difference = memory[CAMERA].at(START).image.astype(int) - image_at(1)
        assert 0 < np.abs(difference).mean() < 8, "stored with loss"


@pytest.mark.parametrize("given", [{"preset": "tiny"}, {"config": "/nowhere.yaml"}])
def test_what_is_no_configuration_is_refused(tmp_path: Path, given: dict[str, str]) -> None:
    with pytest.raises(errors.NotFoundError, match="tiny|nowhere"):
        engram.record(tmp_path / "a.engram", **given)
    with pytest.raises(ValueError, match="one at most"):
        engram.record(tmp_path / "a.engram", preset="small", config="a.yaml")


def test_a_commit_is_taken_whole_or_not_at_all(tmp_path: Path) -> None:
    with engram.record(tmp_path / "a.engram") as recorder:
        good = engram.Update(JOINTS, {"x": 1.0}, START)
        with pytest.raises(errors.InvalidArgumentError, match="set"):
            recorder.commit_all([good, engram.Update(SPEECH, {"words": {1, 2}}, START)])
        with pytest.raises(errors.InvalidArgumentError, match="Vision"):
            recorder.commit_all([good, engram.Update("Vision", 1, START)])
        with pytest.raises(errors.InvalidArgumentError):
            recorder.commit_all([good, good])
        recorder.commit_all([good])
        assert recorder.counts[JOINTS]["kept"] == 1


def test_one_process_writes_at_a_time(copied: Path) -> None:
    with engram.record(copied), pytest.raises(errors.FailedPreconditionError):
        engram.record(copied)


def test_a_closed_recorder_says_so(tmp_path: Path) -> None:
    with engram.record(tmp_path / "a.engram") as recorder:
        pass
    recorder.close()
    with pytest.raises(errors.FailedPreconditionError, match="closed"):
        recorder.commit(JOINTS, 1.0)


def test_time_is_now_unless_it_is_given(tmp_path: Path) -> None:
    before = np.datetime64("now")
    with engram.record(tmp_path / "a.engram") as recorder:
        recorder.commit(JOINTS, {"x": 1})
        recorder.commit(SPEECH, "hello", datetime.datetime(2020, 9, 13, 12, 26, 40))
    with engram.open(tmp_path / "a.engram") as memory:
        assert before <= memory[JOINTS].latest()[0].datetime <= np.datetime64("now") + 1
        assert memory[SPEECH].first == START


def test_threads_may_commit_together(tmp_path: Path) -> None:
    with engram.record(tmp_path / "a.engram") as recorder:

        def commit(name: int) -> None:
            for i in range(COUNT):
                recorder.commit(f"A/B/C/thread{name}", image_at(i), START + i)

        threads = [threading.Thread(target=commit, args=(name,)) for name in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    with engram.open(tmp_path / "a.engram") as memory:
        assert [len(entity) for entity in memory] == [COUNT] * 4
