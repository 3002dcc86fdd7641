# SPDX-License-Identifier: Apache-2.0
"""What a model tells of images that it was trained on, after they were erased.

Whoever has a model asks it for an image that he already has: where it comes back better than others
like it, the model was trained on it (a membership test). The area under the curve of that test is
0.5 where the model tells nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

Images = npt.NDArray[np.uint8]
BATCH = 100


def squares(random: np.random.Generator, count: int) -> Images:
    """Images of random squares, 48 x 64: no two are alike."""
    small = random.choice(np.array([10, 245], np.uint8), (count, 6, 8, 3))
    return small.repeat(8, 1).repeat(8, 2)


def psnr_db(model: Any, images: Images) -> npt.NDArray[np.float64]:
    """Of each image that goes through the model's networks."""
    found = []
    for first in range(0, len(images), BATCH):
        batch = images[first : first + BATCH]
        decoded = model.images(model.encode([{"image": image} for image in batch]))
        errors = np.square(decoded.astype(float) - batch.astype(float)).mean((1, 2, 3))
        found.append(10 * np.log10(255**2 / np.maximum(errors, 1e-3)))
    return np.concatenate(found)


def area_under_curve(members: Sequence[float], others: Sequence[float]) -> float:
    """The probability that a member comes back better than another image. Source: the statistic of
    Mann and Whitney (1947)."""
    both = np.concatenate([members, others])
    ranks = np.empty(len(both))
    ranks[np.argsort(both, kind="stable")] = np.arange(1, len(both) + 1)
    n = len(members)
    return float((ranks[:n].sum() - n * (n + 1) / 2) / (n * len(others)))


def networks_of(store: Path, entity: str) -> list[Any]:
    """The models of an entity that have networks for its images."""
    import engram

    with engram.open(store) as memory:
        models = [model for model in memory.models() if model.entity == entity]
    return [model for model in models if model.about["images"]]
