# SPDX-License-Identifier: Apache-2.0
"""Reading: what is in memory meanwhile, and times in every form."""

from __future__ import annotations

import datetime
import gc
import weakref

import numpy as np
import pytest
from conftest import CAMERA, COUNT, JOINTS, START, STEP, Recorded, time_at
from hypothesis import given
from hypothesis import strategies as st

import engram
from engram.times import duration_ns, to_datetime64, to_ns

NS = st.integers(-(2**62), 2**62)


def test_a_generator_holds_a_few_snapshots_at_a_time(recorded: Recorded) -> None:
    alive: weakref.WeakSet[engram.Snapshot] = weakref.WeakSet()
    max_alive = 0
    with engram.open(recorded.path) as memory:
        for snapshot in memory[CAMERA].snapshots():
            alive.add(snapshot)
            gc.collect()
            max_alive = max(max_alive, len(alive))
    assert max_alive < COUNT / 2


def test_images_outlive_everything_that_they_came_from(recorded: Recorded) -> None:
    with engram.open(recorded.path) as memory:
        images = [one.image for one in memory[CAMERA]]
    del memory
    gc.collect()
    np.testing.assert_array_equal(np.stack(images), recorded.images)
    assert not any(image.flags.writeable for image in images)


def test_reading_copies_no_image(recorded: Recorded) -> None:
    with engram.open(recorded.path) as memory:
        snapshot = memory[CAMERA].at(START)
        assert np.shares_memory(snapshot.image, snapshot.value["image"])
        assert snapshot.image is snapshot.value["image"]


@given(NS)
def test_datetime64_and_ns_are_the_same_times(ns: int) -> None:
    assert to_ns(to_datetime64(ns)) == to_ns(np.int64(ns)) == to_ns(ns) == ns
    assert to_ns(str(to_datetime64(ns))) == ns


@given(st.datetimes(datetime.datetime(1900, 1, 1), datetime.datetime(2200, 1, 1)))
def test_datetimes_are_exact_to_the_microsecond(time: datetime.datetime) -> None:
    assert to_ns(time) == to_ns(np.datetime64(time)) == to_ns(time.isoformat())
    zone = datetime.timezone(datetime.timedelta(hours=5, minutes=30))
    assert to_ns(time.replace(tzinfo=zone)) == to_ns(time) - 19_800 * 10**9


@given(st.integers(-(10**15), 10**15))
def test_durations_are_seconds_or_have_a_unit(microseconds: int) -> None:
    expected = microseconds * 1000
    assert duration_ns(np.timedelta64(microseconds, "us")) == expected
    assert duration_ns(datetime.timedelta(microseconds=microseconds)) == pytest.approx(
        expected, rel=1e-15, abs=1
    )
    assert duration_ns(microseconds) == microseconds * 10**9


def test_every_question_takes_every_form_of_a_time(recorded: Recorded) -> None:
    moment = to_datetime64(time_at(7))
    with engram.open(recorded.path) as memory:
        camera = memory[CAMERA]
        assert camera.at(moment).time == camera.nearest(moment).time == time_at(7)
        assert camera.window(moment, [np.timedelta64(-200, "ms"), 0.2])[1].time == time_at(8)
        assert next(camera.snapshots(moment)).time == time_at(7)
        assert camera.times(moment, moment + np.timedelta64(STEP, "ns")).size == 2
        assert camera.predict(np.timedelta64(STEP, "ns"), at=moment)[0].time == time_at(8)
        with pytest.warns(DeprecationWarning, match="'at' now"):
            assert camera.predict(STEP * 1e-9, start=moment)[0].time == time_at(8)


def test_a_summary_counts_bytes(learned: Recorded) -> None:
    with engram.open(learned.path) as memory:
        summary = memory[JOINTS].summary()
        assert summary["snapshots"] == COUNT and summary["models"] == [1]
        assert min(summary[f"{what}_bytes"] for what in ("raw", "stored", "latent", "model")) > 0
        assert "model v1" in repr(memory[JOINTS]) and "model v1" in repr(memory)
