# SPDX-License-Identifier: Apache-2.0
"""What `make recall-bars` counts, on moments whose answers are known."""
from __future__ import annotations

import numpy as np
import pytest

from experiments.recall import __main__ as recall

SECOND = 10**9


def asked() -> recall.Asked:
    """Two recordings of four moments, 200 ms apart, an hour between them; images are numbers."""
    made = recall.Asked.__new__(recall.Asked)
    first = np.arange(4) * SECOND // 5
    made.times = np.concatenate([first, first + 3600 * SECOND])
    made.recordings = np.repeat([0, 1], 4)
    made.phases = np.array(["pick", "pick", "place", "", "place", "pick", "place", "pick"])
    made.thumbnails = np.array([[0], [1], [5], [9], [1], [0], [5], [6]], np.float32)
    made.choices = np.flatnonzero(made.phases != "")
    made.questions = made.choices
    return made


def test_answers_are_of_other_recordings_and_of_moments_with_a_phase() -> None:
    moments = asked()
    assert moments.others(0).tolist() == [4, 5, 6, 7]
    assert moments.others(5).tolist() == [0, 1, 2]


def test_thumbnails_find_the_nearest_image_elsewhere() -> None:
    moments = asked()
    answers = recall.thumbnail_answers(moments, False, False)
    assert answers.tolist() == [5, 4, 6, 1, 0, 2, 2]
    # pick pick, pick place, place place; place pick, pick pick, place place, pick place.
    assert moments.share_found(answers) == pytest.approx(4 / 7)


def test_random_finds_as_much_as_there_is_of_a_phase() -> None:
    moments = asked()
    shares = [1 / 2, 1 / 2, 1 / 2, 1 / 3, 2 / 3, 1 / 3, 2 / 3]
    assert recall.random_share(moments) == pytest.approx(np.mean(shares))


def test_what_came_before_ends_where_its_recording_begins() -> None:
    assert recall.before(asked(), 0.2).tolist() == [0, 0, 1, 2, 4, 4, 5, 6]
    assert recall.before(asked(), 2).tolist() == [0, 0, 0, 0, 4, 4, 4, 4]


def test_thumbnails_are_means_of_their_cells() -> None:
    image = np.zeros((32, 64, 3), np.uint8)
    image[:2, :4] = (10, 20, 30)
    found = recall.thumbnail(image)
    assert found.shape == (768,)
    assert found[:4].tolist() == [10, 20, 30, 0]
