# SPDX-License-Identifier: Apache-2.0
"""Consolidating, forgetting and checking from Python."""

from __future__ import annotations

import signal
import threading
import time
from pathlib import Path

import pytest
from conftest import CAMERA, COUNT, JOINTS, Recorded

import engram
from engram import errors

QUICK = {"steps": 20, "psnr": 26, "representation": "latents", "width": 16, "threads": 1}


def test_progress_is_told_in_order(copied: Path) -> None:
    told: list[engram.Progress] = []
    report = engram.consolidate(copied, CAMERA, progress=told.append, **QUICK)
    assert [one["entity"] for one in report["entities"]] == [CAMERA]
    assert report["entities"][0]["snapshots"] == COUNT
    train = [one for one in told if one.what == f"train {CAMERA}"]
    assert train and all(0 <= one.done <= one.total == QUICK["steps"] for one in train)
    assert [one.done for one in train] == sorted(one.done for one in train)
    assert any(one.what == f"encode {CAMERA}" for one in told)


def test_the_same_seed_gives_the_same_model(copied: Path, tmp_path: Path) -> None:
    import shutil

    other = tmp_path / "other.engram"
    shutil.copytree(copied, other)
    for path in (copied, other):
        engram.consolidate(path, CAMERA, seed=7, **QUICK)
    with engram.open(copied) as one, engram.open(other) as two:
        a, b = one[CAMERA].model, two[CAMERA].model
        assert Path(a.file).read_bytes() == Path(b.file).read_bytes()


def test_an_open_memory_sees_what_came_of_it(copied: Path) -> None:
    with engram.open(copied) as memory:
        assert memory.models() == []
        engram.consolidate(memory, CAMERA, **QUICK)
        assert [model.entity for model in memory.models()] == [CAMERA]


def test_a_dry_run_changes_nothing(copied: Path) -> None:
    plan = engram.consolidate(copied, dry_run=True, **QUICK)
    assert {one["entity"] for one in plan["entities"]} >= {CAMERA, JOINTS}
    with engram.open(copied) as memory:
        assert memory.models() == []


def test_an_exception_of_progress_stops_the_job(copied: Path) -> None:
    def interrupt(progress: engram.Progress) -> None:
        if progress.done > 3:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        engram.consolidate(copied, CAMERA, progress=interrupt, **{**QUICK, "steps": 100_000})
    assert engram.check(copied)["clean"]


def test_ctrl_c_stops_a_job_without_a_callback(copied: Path) -> None:
    timer = threading.Timer(1.0, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        engram.consolidate(copied, CAMERA, **{**QUICK, "steps": 1_000_000})
    timer.join()
    assert engram.check(copied)["clean"]


def test_a_budget_is_for_everything(copied: Path) -> None:
    start = time.monotonic()
    report = engram.consolidate(copied, CAMERA, representation="video", psnr=30, budget=60)
    assert time.monotonic() - start < 90
    (camera,) = report["entities"]
    assert camera["snapshots"] > 0 and camera["waiting"] == 0


def test_wrong_options_are_refused(copied: Path) -> None:
    with pytest.raises(errors.InvalidArgumentError, match="sketches"):
        engram.consolidate(copied, representation="sketches")
    with pytest.raises(errors.InvalidArgumentError, match="budget"):
        engram.consolidate(copied, budget=-1)
    with pytest.raises(errors.InvalidArgumentError, match="budget"):
        engram.consolidate(copied, training=-1)
    with pytest.raises(errors.NotFoundError):
        engram.consolidate(copied, "No/Such/.*", **QUICK)
    with pytest.raises(TypeError):
        engram.consolidate(copied, nonsense=1)


def test_forgetting_says_first_and_then_does(copied: Path) -> None:
    with engram.open(copied) as memory:
        report = engram.forget(memory, f"{CAMERA} @ latest:3")
        assert report["plan"]["snapshots"] == 3 and "done" not in report
        assert len(memory[CAMERA]) == COUNT
        report = engram.forget(memory, [f"{CAMERA} @ latest:3"], dry_run=False)
        assert report["done"]["snapshots"] == 3
        assert len(memory[CAMERA]) == COUNT - 3
        with pytest.raises(errors.NotFoundError):
            engram.forget(memory, "No/Such/thing/here")
        with pytest.raises(errors.InvalidArgumentError, match="nothing to forget"):
            engram.forget(memory)


def test_erasing_tells_what_it_did(copied: Path) -> None:
    with engram.open(copied) as memory:
        plan = engram.forget(memory, f"{CAMERA} @ latest:3")["plan"]
    report = engram.forget(copied, f"{CAMERA} @ latest:3", dry_run=False, erase=True)
    assert plan["snapshots"] == report["done"]["snapshots"] == 3
    (erased,) = report["done"]["erased"]["entities"]
    assert erased["id"] == CAMERA and erased["erased"] == 3
    assert (copied / report["done"]["erased"]["report"]).is_file()
    assert engram.check(copied)["clean"]


def test_policies_of_a_file_decide_what_goes(copied: Path, tmp_path: Path) -> None:
    config = tmp_path / "forget.yaml"
    config.write_text("forget:\n  rules:\n    - {match: Vision/.*, older_than: 1d}\n")
    plan = engram.forget(copied, config=config)["plan"]
    assert plan["snapshots"] == COUNT - 1, "the newest is protected"


def test_checking_finds_damage_and_names_it(copied: Path) -> None:
    report = engram.check(copied, deep=True)
    assert report["clean"] and report["findings"] == []
    segment = next((copied / "segments").glob("*.h5"))
    damaged = bytearray(segment.read_bytes())
    damaged[len(damaged) // 2] ^= 0xFF
    segment.write_bytes(damaged)
    report = engram.check(copied)
    assert not report["clean"]
    assert segment.name in report["findings"][0]["file"]


def test_bars_need_no_tqdm(
    copied: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    engram.check(copied, progress=True)
    monkeypatch.setitem(__import__("sys").modules, "tqdm.auto", None)
    engram.check(copied, progress=True)
    assert "check" in capsys.readouterr().err


def test_memories_of_jobs_may_be_missing() -> None:
    for job in (engram.check, engram.consolidate):
        with pytest.raises(errors.NotFoundError, match="/nowhere"):
            job("/nowhere/at.all")


def test_reports_are_those_of_recorded_data(recorded: Recorded) -> None:
    report = engram.check(recorded.path)
    assert (report["entities"], report["snapshots"]) == (3, 2 * COUNT + 1)
