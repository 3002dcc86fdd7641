# SPDX-License-Identifier: Apache-2.0
"""PSNR, SSIM and Bjontegaard's rate, where the answer is known."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from experiments.paper import quality

CURVE = [(100.0, 30.0), (200.0, 33.0), (400.0, 36.0), (800.0, 38.5)]


def test_psnr_of_a_known_difference():
    black = np.zeros((16, 16, 3), np.uint8)
    assert quality.psnr_db(black, black + 1) == pytest.approx(20 * math.log10(255))
    assert quality.psnr_db(black, black) == quality.LARGEST_DB


def test_ssim_is_one_for_the_same_and_less_for_another():
    image = np.random.default_rng(1).integers(0, 256, (24, 24, 3)).astype(np.uint8)
    assert quality.ssim(image, image) == pytest.approx(1)
    assert quality.ssim(image, 255 - image) < 0


@settings(deadline=None, max_examples=30)
@given(st.floats(0.1, 10))
def test_the_rate_of_a_scaled_curve_is_its_scale(scale):
    scaled = [(size * scale, db) for size, db in CURVE]
    assert quality.bd_rate(CURVE, scaled) == pytest.approx(scale - 1)


def test_order_of_points_says_nothing():
    assert quality.bd_rate(CURVE, CURVE[::-1]) == pytest.approx(0)


def test_bytes_at_a_quality_lie_between_points():
    assert quality.bytes_at(CURVE, 33.0) == pytest.approx(200)
    assert 200 < quality.bytes_at(CURVE[::-1], 34.0) < 400
    # Worse than what was measured takes no more than that; better is not known.
    assert quality.bytes_at(CURVE, 20.0) == 100
    assert quality.bytes_at(CURVE, 39.0) is None
    assert quality.bytes_at([], 39.0) is None


def test_curves_without_common_qualities_have_no_rate():
    assert quality.bd_rate(CURVE, [(size, db + 20) for size, db in CURVE]) is None
    assert quality.bd_rate(CURVE, CURVE[:1]) is None
