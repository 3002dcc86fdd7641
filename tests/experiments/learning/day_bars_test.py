# SPDX-License-Identifier: Apache-2.0
"""A made day varies, is the same for the same seed, and what a night made of it is judged."""

import importlib.util
import math
import pathlib
import sys

import numpy as np
import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[3] / "experiments" / "learning"


@pytest.fixture
def bars():
    sys.path.insert(0, str(FOLDER))
    spec = importlib.util.spec_from_file_location("day_bars", FOLDER / "day_bars.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def frames():
    return np.random.default_rng(5).integers(0, 200, (10, 24, 32, 3), dtype=np.uint8)


def test_the_same_images_come_however_they_are_asked_for(bars, frames):
    day = bars.Day(frames, 0, 1)
    all_images = day.images(0, 25)
    assert np.array_equal(day.images(7, 9), all_images[7:16])
    assert np.array_equal(bars.Day(frames, 0, 1).images(24, 1)[0], all_images[24])
    assert not np.array_equal(bars.Day(frames, 0, 2).images(0, 25), all_images)
    assert not np.array_equal(bars.Day(frames, 1, 1).images(0, 25), all_images)


def test_each_turn_through_the_recordings_looks_different(bars, frames):
    day = bars.Day(frames, 0, 1)
    images = day.images(0, 40).astype(int)
    means = [images[turn * 10: turn * 10 + 10].mean() for turn in range(4)]
    assert len({round(mean) for mean in means}) == 4
    # Noise is of each image, not of the recording's.
    still = bars.Day(np.full((1, 24, 32, 3), 100, np.uint8), 0, 1).images(0, 2).astype(int)
    assert 0.1 < still[0].std() < 3


def night(**more):
    entity = {"entity": "Vision/RGB/head/cam0", "encoded": 100, "bytes_an_image": 90.0,
              "video": "av1:effort=5", "notes": []}
    return {"images": 100, "size": "128x128", "psnr_db": 35.0, "budget": None, "seconds": 5.0,
            "processor_seconds": 4.0, "megabytes": 400, "entities": [entity], "looks": 10,
            "found": 10, "lowest_psnr_db": 35.2, **more}


def test_a_night_is_judged(bars, capsys):
    assert bars.show(night())
    assert "40.0 ms for each of the 100 images" in capsys.readouterr().out
    assert not bars.show(night(lowest_psnr_db=34.9))
    assert not bars.show(night(megabytes=1501))
    assert not bars.show(night(found=0, lowest_psnr_db=math.inf)), "nothing was compared"
    assert not bars.show(night(entities=[{"entity": "a", "skipped": "nothing new"}]))
