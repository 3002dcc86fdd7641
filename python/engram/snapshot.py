# SPDX-License-Identifier: Apache-2.0
"""What a memory answers: moments of entities."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from engram.errors import NotFoundError
from engram.idf.value import Value
from engram.times import to_datetime64


@dataclass(frozen=True)
class MeasuredError:
    """How far a value is from what was recorded: measured, or expected of a prediction."""

    image_mse: float | None  #: Of images, in grey levels squared.
    number_mse: float | None  #: Of other numbers, in their units squared.

    @property
    def psnr_db(self) -> float | None:
        """PSNR of the images, on 8 bits and from the pooled squared error of this instance."""
        if self.image_mse is None:
            return None
        return 10 * math.log10(255.0**2 / self.image_mse) if self.image_mse > 0 else math.inf

    @property
    def rmse(self) -> float | None:
        """Root mean squared error of the numbers."""
        return None if self.number_mse is None else math.sqrt(self.number_mse)


@dataclass(frozen=True)
class MemberPrediction:
    """How one member of a predicted value was predicted: each may have an engine of its own."""

    path: str  #: "pose/position"; empty: the value itself.
    engine: str  #: "copy-last" where it is the last known value.
    expected_mse: float | None  #: Grey levels of an image, else the numbers' unit, squared.
    bound_mse: float | None  #: What the real one stays within, 9 times of 10. None: no promise.
    copied: float  #: Share of the last known value in it, 0 to 1.
    is_image: bool
    is_moving: bool  #: It moved when the prediction was made; errors are those of such moments.
    is_counted: bool = True  #: False: it is only ever copied (bools, times, named numbers).

    @property
    def rmse(self) -> float | None:
        """The root mean squared error to expect. Unit: grey levels, or that of the numbers."""
        return None if self.expected_mse is None else math.sqrt(self.expected_mse)


@dataclass(frozen=True, eq=False)  # Arrays have no one truth.
class Instance:
    """One datum of a moment, and where it comes from."""

    index: int
    value: Value
    created: int  #: Measured by its producer; ns since 1970, as the two below.
    sent: int
    arrived: int
    provider: str
    confidence: float  #: 0 to 1.
    origin: str  #: What it was made of on purpose; empty: nobody changed it.
    recipe: str  #: How; likewise.
    error: MeasuredError | None  #: None where it is as it was recorded.
    bound: MeasuredError | None  #: Of a prediction, 9 times of 10; of what faded always.
    members: tuple[MemberPrediction, ...] = ()  #: Of a prediction: how each was predicted.


@dataclass(frozen=True, eq=False)  # Arrays have no one truth.
class Snapshot:
    """One moment of an entity. `value`, `image` and `error` are those of its first instance."""

    entity: str
    time: int  #: ns since 1970, UTC.
    source: str  #: "recorded", "reconstructed", "augmented", "predicted".
    model: str  #: Which decoded or predicted it; empty: none did.
    predictor: str  #: The engine; "mixed": several, see Instance.members.
    horizon: int  #: ns behind the last known moment; 0 unless predicted.
    instances: tuple[Instance, ...]
    plan: str = ""  #: Entity whose planned numbers a prediction was told; empty: none.

    @property
    def datetime(self) -> np.datetime64:
        return to_datetime64(self.time)

    @property
    def value(self) -> Value:
        return self._first.value

    @property
    def image(self) -> npt.NDArray[np.uint8]:
        """(H, W, 3) or (H, W, 1) uint8: a view that cannot be written.

        Raises NotFoundError where the value has no member `image`.
        """
        value = self.value
        image = value.get("image") if isinstance(value, dict) else value
        if isinstance(image, np.ndarray) and image.dtype == np.uint8 and image.ndim == 3:
            return image
        raise NotFoundError(f"'{self.entity}' at {self.datetime}: has no image")

    @property
    def error(self) -> MeasuredError | None:
        return self._first.error

    @property
    def _first(self) -> Instance:
        if not self.instances:
            raise NotFoundError(f"'{self.entity}' at {self.datetime}: has no instance")
        return self.instances[0]

    def __repr__(self) -> str:
        count = "" if len(self.instances) == 1 else f", {len(self.instances)} instances"
        return f"<Snapshot {self.entity} {self.datetime} {self.source}{count}>"


@dataclass(frozen=True)
class Engine:
    """A way to predict an entity, and what it was worth on the entity's own past."""

    name: str  #: "deep", "copy-last", "line", ...
    model: str  #: Empty: it needs none.
    predictions: int  #: That it was measured on.
    error: MeasuredError | None  #: Their mean error.
    bound: MeasuredError | None  #: That 9 of 10 stay within.


def engine_of(found: dict[str, Any]) -> Engine:
    """An engine of what the C++ side says of it."""
    error, bound = _error_of(found.pop("error")), _error_of(found.pop("bound"))
    return Engine(error=error, bound=bound, **found)


def snapshot_of(found: dict[str, Any]) -> Snapshot:
    """A snapshot of what the C++ side says of it."""
    instances = tuple(_instance_of(one) for one in found.pop("instances"))
    return Snapshot(instances=instances, **found)


def _instance_of(found: dict[str, Any]) -> Instance:
    error, bound = _error_of(found.pop("error")), _error_of(found.pop("bound"))
    members = tuple(MemberPrediction(**one) for one in found.pop("members"))
    return Instance(error=error, bound=bound, members=members, **found)


def _error_of(found: dict[str, Any] | None) -> MeasuredError | None:
    return None if found is None else MeasuredError(**found)
