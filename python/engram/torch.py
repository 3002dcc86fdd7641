# SPDX-License-Identifier: Apache-2.0
"""Memories as data sets of PyTorch.

    from engram.torch import SnapshotDataset

    images = SnapshotDataset("robot.engram", "Vision/RGB/head/cam")
    for batch in torch.utils.data.DataLoader(images, batch_size=16, num_workers=2):
        ...  # (16, 3, H, W) uint8
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import numpy as np

from engram import _core
from engram.entity import Entity
from engram.errors import NotFoundError
from engram.frame import numbers_of
from engram.memory import Memory
from engram.optional import needs
from engram.snapshot import Snapshot
from engram.times import TimeLike, to_ns

torch: Any = needs("torch", "engram.torch")


def image_tensor(snapshot: Snapshot) -> Any:
    """The image of a snapshot as (C, H, W) uint8."""
    # A view of the memory cannot be written, and PyTorch has no such tensors: copied once.
    return torch.from_numpy(np.array(snapshot.image.transpose(2, 0, 1)))


def number_tensor(snapshot: Snapshot) -> Any:
    """All numbers of a snapshot as (K,) float32, in the order of its members."""
    return torch.tensor(np.asarray(numbers_of(snapshot.value), np.float32))


class SnapshotDataset(torch.utils.data.Dataset):  # type: ignore[misc]
    """The snapshots of an entity from `start` to `end`, by their place in time.

    `transform` makes an item of a Snapshot: image_tensor (the default), number_tensor, or any
    function that can be pickled. Each process, workers of a DataLoader too, opens the memory for
    itself when it first reads, and decodes on one thread; the moments are those that were there
    when the data set was made.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        entity: str,
        start: TimeLike | None = None,
        end: TimeLike | None = None,
        prefer: str = "recorded",
        transform: Callable[[Snapshot], Any] = image_tensor,
    ) -> None:
        self.path = os.path.abspath(os.fspath(path))
        self.entity = entity
        self.prefer = prefer
        self.transform = transform
        with Memory(self.path, prefer) as memory:
            self.times = memory[entity].times(start, end)
        self._opened: tuple[int, Entity] | None = None

    def __len__(self) -> int:
        return len(self.times)

    def __getitem__(self, index: int) -> Any:
        time = to_ns(self.times[index])
        try:
            snapshot = self._entity().at(time)
        except NotFoundError as error:
            raise NotFoundError(f"{error} (forgotten since the data set was made?)") from error
        if snapshot.source == "predicted":
            raise NotFoundError(f"{snapshot!r}: forgotten since the data set was made?")
        return self.transform(snapshot)

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_opened": None}

    def _entity(self) -> Entity:
        process = os.getpid()
        if self._opened is None or self._opened[0] != process:
            if torch.utils.data.get_worker_info() is not None:
                _core.set_threads(1)
            self._opened = (process, Memory(self.path, self.prefer)[self.entity])
        return self._opened[1]
