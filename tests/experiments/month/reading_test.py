# SPDX-License-Identifier: Apache-2.0
"""What was dropped is compared with what it was at first."""

import numpy as np
import pytest

reading = pytest.importorskip("experiments.month.reading")
IMAGE = np.full((4, 4, 3), 100, np.uint8)


def again(seen):
    """What the next night knows."""
    seen.save()
    return reading.Seen(seen.file)


@pytest.fixture
def seen(tmp_path):
    return reading.Seen(tmp_path / "seen.npz")


def test_video_decodes_to_the_same_bits(seen):
    assert not seen.is_changed(5, IMAGE, True)
    seen = again(seen)
    assert not seen.is_changed(5, IMAGE, True)
    other = IMAGE.copy()
    other[0, 0, 0] += 1
    assert seen.is_changed(5, other, True)
    assert seen.is_changed(5, other, False), "it was video at first"


def test_networks_may_differ_by_one_grey_level(seen):
    assert not seen.is_changed(5, IMAGE, False)
    seen = again(seen)
    assert not seen.is_changed(5, IMAGE + np.uint8(1), False)
    assert seen.is_changed(5, IMAGE - np.uint8(2), False)


def test_moments_are_kept_from_night_to_night(seen):
    seen.moments[reading.days.CAMERA] |= {3, 5}
    assert again(seen).moments[reading.days.CAMERA] == {3, 5}


def test_quality_is_measured():
    assert reading.psnr(IMAGE, IMAGE) == np.inf
    assert reading.psnr(IMAGE, IMAGE + np.uint8(1)) == pytest.approx(48.13, abs=0.01)
