# SPDX-License-Identifier: Apache-2.0
"""What a store tells about itself, from Python."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import engram
from engram import errors

ARM = "Robot/State/arm/joint"
STEP = 20_000_000


@pytest.fixture
def store(tmp_path: Path) -> Path:
    path = tmp_path / "arm.engram"
    with engram.record(path) as recorder:
        for i in range(200):
            value = math.nan if i == 100 else math.sin(0.05 * i)
            recorder.commit(ARM, {"x": value}, STEP * (i + 1))
    return path


def test_findings_say_what_and_where(store: Path) -> None:
    report = engram.reflect(store)
    assert report["snapshots"] == 200
    (finding,) = report["findings"]
    assert finding["kind"] == "not-finite"
    assert finding["entity"] == ARM
    assert finding["first_ns"] == 101 * STEP
    assert report["entities"][0]["rate_hz"] == pytest.approx(50)


def test_a_query_and_another_store_may_be_given(store: Path) -> None:
    assert engram.reflect(store, "Robot @ 0..50")["findings"] == []
    assert engram.reflect(store, against=store)["differences"] == []


def test_what_was_found_can_be_asked_for(store: Path) -> None:
    with engram.open(store) as memory:
        engram.reflect(memory, commit=True)
        (findings,) = memory.query("Reflection/Findings @ latest").values()
        assert findings[0].value["kind"] == "not-finite"


def test_errors_say_what_was_found(store: Path) -> None:
    with pytest.raises(errors.NotFoundError, match="/nowhere"):
        engram.reflect("/nowhere/at.all")
    with pytest.raises(errors.InvalidArgumentError, match="nonsense"):
        engram.reflect(store, "a @ nonsense")
