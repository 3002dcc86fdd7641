# SPDX-License-Identifier: Apache-2.0
"""A memory that is read: `with engram.open("robot.engram") as memory: ...`."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from engram import _core
from engram.closing import Closing
from engram.errors import InvalidArgumentError, NotFoundError
from engram.frame import frame_of
from engram.model import Latents, Model, latents_of
from engram.snapshot import Engine, Snapshot, engine_of, snapshot_of
from engram.times import DurationLike, TimeLike, duration_ns, to_datetime64, to_ns

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import]

_SNAPSHOTS_AT_ONCE = 16
_TIMES_AT_ONCE = 100_000
_PREFER = {"recorded": False, "latent": True}


class Entity:
    """One thing over time: its past, and what is predicted of it.

    `prefer` is "recorded" or "latent": which form answers where a moment has both.
    """

    def __init__(self, store: _core.OpenStore, name: str, prefer: str) -> None:
        self._store = store
        self._prefers_latents = _prefers_latents(prefer)
        self.name = name

    def __len__(self) -> int:
        """Moments that are kept."""
        return int(self._store.summary(self.name)["snapshots"])

    @property
    def first(self) -> int:
        """Time of the first moment, in ns."""
        return int(self._store.summary(self.name)["first"])

    @property
    def last(self) -> int:
        """Time of the last moment, in ns."""
        return int(self._store.summary(self.name)["last"])

    def summary(self) -> dict[str, Any]:
        """What there is of it: "snapshots", "first", "last" (ns), "models" (versions), and bytes.

        "raw_bytes": plain; "stored_bytes": as recorded; "latent_bytes", "model_bytes": as learned.
        """
        return self._store.summary(self.name)

    def at(self, time: TimeLike) -> Snapshot:
        """The moment at exactly this time; behind the last one, a prediction.

        Raises NotFoundError where there is none.
        """
        return self._one(f"time:{to_ns(time)}")

    def nearest(self, time: TimeLike) -> Snapshot:
        """The moment that is closest in time, never a prediction."""
        return self._one(f"nearest:{to_ns(time)}")

    def latest(self, count: int = 1) -> list[Snapshot]:
        """The last `count` moments, oldest first."""
        return self._select(f"latest:{count}")

    def ahead(self, duration: DurationLike) -> Snapshot:
        """A prediction so long (seconds) behind the last moment."""
        return self.at(self.last + duration_ns(duration))

    def predict(
        self,
        ahead: DurationLike | Sequence[DurationLike],
        start: TimeLike | None = None,
        engine: str = "",
    ) -> list[Snapshot]:
        """What is expected so long (seconds) after the last moment up to `start` (None: the newest).

        Nothing after `start` is looked at: what really came can be compared. `engine`: one of
        engines(); empty: the one that was best on the past, for each horizon.
        Raises NotFoundError, InvalidArgumentError where a horizon is too far ahead.
        """
        horizons = [ahead] if isinstance(ahead, (int, float, np.timedelta64)) else ahead
        if not isinstance(horizons, Sequence):
            horizons = [horizons]
        found = self._store.predict(
            self.name,
            [duration_ns(one) for one in horizons],
            None if start is None else to_ns(start),
            engine,
            self._prefers_latents,
        )
        return [snapshot_of(one) for one in found]

    def engines(self, ahead: DurationLike, start: TimeLike | None = None) -> list[Engine]:
        """All ways to predict so long (seconds) ahead, the best on the past of the entity first."""
        found = self._store.engines(
            self.name, duration_ns(ahead), None if start is None else to_ns(start)
        )
        return [engine_of(one) for one in found]

    def window(self, time: TimeLike, offsets: Sequence[DurationLike]) -> list[Snapshot]:
        """What was closest to each of `time` + offset (seconds); predictions of the future."""
        times = [to_ns(time) + duration_ns(offset) for offset in offsets]
        last = self.last
        return [self.at(one) if one > last else self.nearest(one) for one in times]

    def snapshots(
        self, start: TimeLike | None = None, end: TimeLike | None = None
    ) -> Iterator[Snapshot]:
        """The moments from `start` to `end`, both included, in order; a few are in memory."""
        after = None if start is None else to_ns(start) - 1
        stop = None if end is None else to_ns(end)
        while True:
            times = self._store.times(self.name, after, _SNAPSHOTS_AT_ONCE)
            wanted = [time for time in times if stop is None or time <= stop]
            if not wanted:
                return
            yield from self._select(f"time:{wanted[0]}..{wanted[-1]}")
            if len(wanted) < _SNAPSHOTS_AT_ONCE:
                return
            after = wanted[-1]

    def __iter__(self) -> Iterator[Snapshot]:
        return self.snapshots()

    def times(
        self, start: TimeLike | None = None, end: TimeLike | None = None
    ) -> npt.NDArray[np.datetime64]:
        """The moments from `start` to `end`, both included, as datetime64[ns]; decodes nothing."""
        after = None if start is None else to_ns(start) - 1
        stop = None if end is None else to_ns(end)
        times: list[int] = []
        while True:
            found = self._store.times(self.name, after, _TIMES_AT_ONCE)
            times += [time for time in found if stop is None or time <= stop]
            if len(found) < _TIMES_AT_ONCE or (stop is not None and found[-1] > stop):
                return np.asarray(times, np.int64).astype("datetime64[ns]")
            after = found[-1]

    def frame(self, start: TimeLike | None = None, end: TimeLike | None = None) -> pd.DataFrame:
        """The numbers, bools and texts from `start` to `end` as a DataFrame (needs pandas).

        A row per moment, indexed by time (UTC); arrays of up to 1,024 numbers are columns by place:
        "position/0".
        """
        return frame_of(self.snapshots(start, end))

    def errors(self) -> dict[str, npt.NDArray[Any]]:
        """How each moment that has latents is kept, as columns, decoding nothing.

        "time", "model" (version), "form" of its images ("latents", "refined", "residual", "video",
        "lossless"), "bytes", "psnr_db" and "rmse" as they were measured when it was made.
        `pandas.DataFrame(entity.errors())` takes it.
        """
        columns = self._store.stored_snapshots(self.name)
        columns["time"] = columns["time"].astype("datetime64[ns]")
        columns["form"] = np.asarray(columns["form"], dtype=str)
        return columns

    @property
    def model(self) -> Model:
        """The newest model. Raises NotFoundError where there is none."""
        found = [one for one in self._store.models() if one["entity"] == self.name]
        if not found:
            raise NotFoundError(f"'{self.name}': has no model, needs engram.consolidate first")
        return Model(**max(found, key=lambda one: int(one["version"])))

    def latents(self, start: TimeLike | None = None, end: TimeLike | None = None) -> Latents:
        """What the newest model keeps from `start` to `end`, as arrays: images are not decoded."""
        model = self.model
        first = -(2**63) if start is None else to_ns(start)
        last = 2**63 - 1 if end is None else to_ns(end)
        return latents_of(self._store.latents(self.name, model.version, first, last, model._open))

    def __repr__(self) -> str:
        about = self._store.summary(self.name)
        models = f", model v{about['models'][-1]}" if about["models"] else ""
        return (
            f"<Entity {self.name}: {about['snapshots']:,} snapshots, "
            f"{to_datetime64(about['first'])} to {to_datetime64(about['last'])}, "
            f"{_bytes(about['stored_bytes'] + about['latent_bytes'])}{models}>"
        )

    def _select(self, selector: str) -> list[Snapshot]:
        found = self._store.select(self.name, selector, self._prefers_latents)
        return [snapshot_of(one) for one in found]

    def _one(self, selector: str) -> Snapshot:
        found = self._select(selector)
        if not found:
            raise NotFoundError(f"'{self.name}': has no moment '{selector}'")
        return found[0]


class Memory(Closing):
    """A store that is open for reading; any number may read beside one that writes.

    What is answered stays valid when the memory is closed. Any thread may ask; answers of one
    memory come one after the other, and other threads of Python run meanwhile.
    """

    def __init__(self, path: str | os.PathLike[str], prefer: str = "recorded") -> None:
        self.path = os.fspath(path)
        self._prefer = prefer
        self._prefers_latents = _prefers_latents(prefer)
        self._store = _core.OpenStore(self.path)

    @property
    def entities(self) -> list[str]:
        """Their names, "Memory/Core/Provider/Entity", in order."""
        return self._store.entities()

    def __getitem__(self, name: str) -> Entity:
        """Raises NotFoundError, which lists what there is."""
        self._store.summary(name)
        return Entity(self._store, name, self._prefer)

    def __contains__(self, name: object) -> bool:
        return name in self.entities

    def __iter__(self) -> Iterator[Entity]:
        return (Entity(self._store, name, self._prefer) for name in self.entities)

    def __len__(self) -> int:
        return len(self.entities)

    def query(self, text: str) -> dict[str, list[Snapshot]]:
        """The answer to a query in its text form (docs/query.md), by entity."""
        found = self._store.query(text, self._prefers_latents)
        return {entity: [snapshot_of(one) for one in snapshots] for entity, snapshots in found}

    def models(self) -> list[Model]:
        """All models, older ones first."""
        return [Model(**one) for one in self._store.models()]

    def refresh(self) -> None:
        """Sees what was committed, learned or forgotten since it was opened."""
        self._store.refresh()

    def close(self) -> None:
        self._store.close()

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled by path: another process opens it anew."""
        return Memory, (self.path, self._prefer)

    def __repr__(self) -> str:
        entities = list(self)
        lines = [f"<Memory {self.path}: {len(entities)} entities"]
        lines += [f"  {entity!r}" for entity in entities[:20]]
        if len(entities) > 20:
            lines.append(f"  and {len(entities) - 20} more")
        return "\n".join(lines) + ">"


def open(path: str | os.PathLike[str], prefer: str = "recorded") -> Memory:  # noqa: A001
    """Opens a store for reading. `prefer`: as Entity says.

    Raises NotFoundError, DataLossError, FailedPreconditionError (a newer format).
    """
    return Memory(path, prefer)


def _prefers_latents(prefer: str) -> bool:
    if prefer not in _PREFER:
        raise InvalidArgumentError(f"prefer '{prefer}': needs 'recorded' or 'latent'")
    return _PREFER[prefer]


def _bytes(count: int) -> str:
    size = float(count)
    for unit in ("B", "kB", "MB", "GB"):
        if size < 1000:
            return f"{size:.3g} {unit}"
        size /= 1000
    return f"{size:.3g} TB"
