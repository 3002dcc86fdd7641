# SPDX-License-Identifier: Apache-2.0
"""Models that were trained on a memory, looked into."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from engram import _core
from engram.errors import InvalidArgumentError
from engram.idf.value import Value, at, split_path
from engram.snapshot import MeasuredError, Snapshot

IntArray = npt.NDArray[np.int32]
Values = Union[npt.NDArray[np.uint8], Iterable[Union[Snapshot, Value]]]

_PHASES = ("autoencoder", "dynamics", "motion")


@dataclass(frozen=True, eq=False)
class Latents:
    """What a model makes of N values, as arrays to plot, cluster and change.

    Image latents are integers: a grid of coarse ones (a place is 16 x 16 pixels, more for large
    images), then one of fine ones (half of that); `Model.grids` has their shapes.
    """

    images: Mapping[str, IntArray]  #: Per image member (N, L).
    numbers: npt.NDArray[np.float64]  #: (N, K), of the members that `Model.numbers` names.
    scenes: npt.NDArray[np.int64]  #: (N,), the background that each image is seen on.
    remainders: tuple[list[Value], ...]  #: What cannot be a tensor, as it was: texts, lists.
    #: Per image member (N,): False where a stored image has another form; its latents are zero.
    is_latent: Mapping[str, npt.NDArray[np.bool_]]
    times: npt.NDArray[np.datetime64] | None = None  #: (N,), of latents out of a store.

    def __len__(self) -> int:
        return len(self.scenes)

    @property
    def array(self) -> IntArray:
        """(N, L) of the only image member; of several, side by side."""
        if not self.images:
            return np.zeros((len(self), 0), np.int32)
        return np.concatenate(list(self.images.values()), axis=1)

    def __array__(self, dtype: Any = None, copy: Any = None) -> npt.NDArray[Any]:
        return self.array if dtype is None else self.array.astype(dtype)


@dataclass(frozen=True, eq=False)
class Prediction:
    """A value that a model expects, and how wrong it may be."""

    steps: int  #: Ahead of the last value that was given.
    value: Value
    error: MeasuredError  #: Expected.
    bound: MeasuredError  #: Kept 9 times of 10.


class Model:
    """The autoencoder and the predictor of one entity. Opened when it is first used.

    Any thread may ask; calls come one after the other, and other threads run meanwhile.
    """

    def __init__(self, entity: str, version: int, file: str, bytes: int) -> None:  # noqa: A002
        self.entity = entity
        self.version = version
        self.file = file
        self.bytes = bytes

    @cached_property
    def _open(self) -> _core.InspectedModel:
        return _core.InspectedModel(self.file)

    @cached_property
    def about(self) -> dict[str, Any]:
        """What it was trained on and for: "snapshots", "steps", "variant", "psnr_db", "seed", ..."""
        return self._open.about()

    @property
    def grids(self) -> dict[str, tuple[tuple[int, int, int], tuple[int, int, int]]]:
        """Per image member (channels, height, width) of its coarse and of its fine latents."""
        return dict(self.about["images"])

    @property
    def numbers(self) -> list[str]:
        """The member that each of `Latents.numbers` is of."""
        return list(self.about["numbers"])

    @cached_property
    def weights(self) -> dict[str, npt.NDArray[np.float32]]:
        """Weights, biases and backgrounds by name: arrays that cannot be written."""
        return self._open.weights()

    @property
    def training_curve(self) -> dict[str, npt.NDArray[Any]]:
        """How training went, as columns: "phase", "step", "seconds", "loss", "psnr_db", "bytes".

        Smoothed means; 64 points at most. `pandas.DataFrame(model.training_curve)` takes it.
        Empty for models of older versions.
        """
        points = self.about["curve"]
        columns = list(zip(*points, strict=True)) if points else [()] * 6
        psnr = np.asarray(columns[4], np.float64)
        return {
            "phase": np.asarray([_PHASES[phase] for phase in columns[0]], dtype=str),
            "step": np.asarray(columns[1], np.int64),
            "seconds": np.asarray(columns[2], np.float64),
            "loss": np.asarray(columns[3], np.float64),
            "psnr_db": np.where(psnr > 0, psnr, np.nan),
            "bytes": np.asarray(columns[5], np.float64),
        }

    def encode(self, values: Values) -> Latents:
        """Latents of images (N, H, W, C), or of values or snapshots of the entity.

        Those of one recording belong together: all are seen on the background that suits them best.
        Raises InvalidArgumentError where a value has another layout than the model.
        """
        return latents_of(self._open.encode(self._values(values)))

    def decode(self, latents: Latents) -> Any:
        """Images (N, H, W, C) uint8 where the entity has nothing else, else a list of values.

        Latents that are no integers, such as those between two others, are rounded.

        Residuals that a store keeps beside latents are no part of it: these are what the networks
        make. Raises FailedPreconditionError where the model has no networks for its images.
        """
        given = {
            "images": {path: _integers(array, path) for path, array in latents.images.items()},
            "numbers": latents.numbers,
            "scenes": latents.scenes,
            "remainders": list(latents.remainders),
        }
        values = self._open.decode(given)
        path = self._only_image()
        if path is None or len(self.about["members"]) > 1 or any(latents.remainders):
            return values
        return np.stack([_image_of(value, path) for value in values]) if values else values

    def images(self, latents: Latents) -> npt.NDArray[np.uint8]:
        """decode(), and of what comes out the only image member: (N, H, W, C) uint8."""
        path = self._needs_only_image("images")
        decoded = self.decode(latents)
        if isinstance(decoded, np.ndarray):
            return decoded
        return np.stack([_image_of(value, path) for value in decoded])

    def global_codes(self, values: Values) -> npt.NDArray[np.float32]:
        """(N, 48): codes that are near each other where images look alike."""
        return self._open.global_codes(self._values(values))

    def predict(self, past: Values, steps: int = 1) -> list[Prediction]:
        """What comes 1, 2, ... `steps` steps (of `step_seconds`) after the last of `past`.

        Two values of the past are enough; more are not looked at.
        """
        found = self._open.predict(self._values(past), steps)
        return [
            Prediction(
                i + 1, one["value"], MeasuredError(**one["error"]), MeasuredError(**one["bound"])
            )
            for i, one in enumerate(found)
        ]

    @property
    def step_seconds(self) -> float:
        """Time between two snapshots that its predictions step by."""
        return float(self.about["step"]) / 1e9

    def __repr__(self) -> str:
        return f"<Model {self.entity} v{self.version}: {self.bytes:,} bytes>"

    def _values(self, given: Values) -> list[Any]:
        if isinstance(given, np.ndarray):
            if given.ndim != 4:
                raise InvalidArgumentError(
                    f"images: found shape {given.shape}, needs (N, height, width, channels)"
                )
            path = self._needs_only_image("an array of images")
            return [_value_of(image, path) for image in given]
        return [one.value if isinstance(one, Snapshot) else one for one in given]

    def _only_image(self) -> str | None:
        members = self.about["members"]
        images = [path for path, kind in members.items() if kind == "image"]
        return images[0] if len(images) == 1 else None

    def _needs_only_image(self, what: str) -> str:
        path = self._only_image()
        if path is None:
            raise InvalidArgumentError(
                f"{what}: '{self.entity}' has not one image member but {self.about['members']}; "
                "needs values"
            )
        return path


def latents_of(found: dict[str, Any]) -> Latents:
    """Latents of what the C++ side says of them."""
    times = found.get("times")
    return Latents(
        images=found["images"],
        numbers=found["numbers"],
        scenes=found["scenes"],
        remainders=tuple(found["remainders"]),
        is_latent=found["is_latent"],
        times=None if times is None else np.asarray(times).astype("datetime64[ns]"),
    )


def _integers(array: npt.NDArray[Any], path: str) -> IntArray:
    given = np.asarray(array)
    if given.dtype.kind not in "iuf" or not np.isfinite(given).all():
        raise InvalidArgumentError(f"latents of '{path}': found {given.dtype}, needs finite numbers")
    made: IntArray = np.clip(np.rint(given), -(2**30), 2**30).astype(np.int32)
    return made


def _value_of(image: npt.NDArray[np.uint8], path: str) -> Value:
    value: Value = image
    for name in reversed(split_path(path) if path else []):
        value = {name: value}
    return value


def _image_of(value: Any, path: str) -> npt.NDArray[np.uint8]:
    image: npt.NDArray[np.uint8] = at(value, path)  # type: ignore[assignment]
    return image
