# SPDX-License-Identifier: Apache-2.0
"""What a snapshot is worth: what Entity.why_salient gives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from engram.times import to_datetime64


@dataclass(frozen=True)
class SalientPart:
    """One part of the saliency of a snapshot."""

    part: str  #: "change", "surprise", "novelty", "outcome", "speech", "links" or "reads".
    value: float  #: 0 to 1.
    weight: float  #: How much it counts; all together 1.
    contribution: float  #: Their product.
    found: str  #: What was found; empty if nothing was.
    expected: str  #: What was expected instead, or what it is measured by.


@dataclass(frozen=True)
class Salient:
    """The saliency of one snapshot, and why it has it."""

    entity: str
    time: int  #: In ns.
    saliency: float  #: 0 to 1, the sum of all contributions.
    rank: int  #: 1 for the most salient snapshot of its entity.
    count: int  #: Snapshots of the entity that have a saliency.
    is_stored: bool  #: False: no night has looked at it, so it was calculated just now.
    learned_from: int  #: Snapshots whose reads the weights were learned from; 0: standard weights.
    parts: list[SalientPart]  #: The greatest contribution first.

    @property
    def datetime(self) -> np.datetime64:
        """Its time, in ns."""
        return to_datetime64(self.time)

    def __getitem__(self, part: str) -> SalientPart:
        """A part by its name. Raises KeyError."""
        for one in self.parts:
            if one.part == part:
                return one
        raise KeyError(part)


def salient_of(entity: str, found: dict[str, Any]) -> Salient:
    parts = [SalientPart(**one) for one in found.pop("parts")]
    return Salient(entity=entity, parts=parts, **found)
