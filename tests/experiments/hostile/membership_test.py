# SPDX-License-Identifier: Apache-2.0
"""What the test of membership says where the answer is known."""

import numpy as np
import pytest

from experiments.hostile.membership import area_under_curve, squares


def test_the_area_says_how_often_a_member_is_better() -> None:
    assert area_under_curve([3, 4], [1, 2]) == 1
    assert area_under_curve([1, 2], [3, 4]) == 0
    assert area_under_curve([1, 4], [2, 3]) == 0.5
    assert area_under_curve([2.5, 2.6, 9], [1, 2, 3, 4]) == pytest.approx(8 / 12)


def test_no_two_images_are_alike() -> None:
    images = squares(np.random.default_rng(0), 50)
    assert images.shape == (50, 48, 64, 3)
    assert len({image.tobytes() for image in images}) == 50
