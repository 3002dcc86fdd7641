# SPDX-License-Identifier: Apache-2.0
"""Moments that are like another one: what Entity.similar gives."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from engram.times import to_datetime64


@dataclass(frozen=True)
class SimilarMoment:
    """A moment that is like the one that was asked with."""

    time: int  #: In ns.
    distance: float  #: 0: equal codes. 1: as different as two moments of the memory at random.
    recording: tuple[int, int]  #: The first and the last moment of its recording, in ns.

    @property
    def datetime(self) -> np.datetime64:
        """Its time, in ns."""
        return to_datetime64(self.time)


@dataclass(frozen=True)
class Similar:
    """Moments of one entity, the most alike first, and what they were compared by."""

    entity: str
    space: str  #: "images 8c21fe03", "numbers"; distances of other spaces are not comparable.
    compared: int  #: Moments that were compared.
    computed: int  #: Images that had to be decoded, because no night had coded them.
    moments: list[SimilarMoment]

    def __iter__(self) -> Iterator[SimilarMoment]:
        return iter(self.moments)

    def __len__(self) -> int:
        return len(self.moments)

    def __getitem__(self, index: int) -> SimilarMoment:
        return self.moments[index]


@dataclass(frozen=True)
class MomentMap:
    """Moments of one entity in two dimensions: those that are like each other are near."""

    entity: str
    space: str  #: As that of Similar.
    known: int  #: Moments that have codes; those of the map are evenly spread among them.
    explained: float  #: The share of the variance of the codes that two dimensions have, 0 to 1.
    times: npt.NDArray[np.int64]  #: [M] in ns, increasing.
    x: npt.NDArray[np.float32]  #: [M]. Unit: the distance of two moments at random.
    y: npt.NDArray[np.float32]  #: [M]
    recordings: npt.NDArray[np.uint32]  #: [M], which recording each is of, from 0 on.

    def __len__(self) -> int:
        return len(self.times)


def similar_of(entity: str, found: dict[str, Any]) -> Similar:
    moments = [SimilarMoment(**one) for one in found["moments"]]
    return Similar(entity, found["space"], found["compared"], found["computed"], moments)
