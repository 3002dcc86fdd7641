# SPDX-License-Identifier: Apache-2.0
"""A memory that is read: `with engram.open("robot.engram") as memory: ...`."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from types import TracebackType

from engram import _core
from engram.errors import InvalidArgumentError, NotFoundError
from engram.snapshot import Snapshot, snapshot_of
from engram.times import DurationLike, TimeLike, duration_ns, to_datetime64, to_ns

_SNAPSHOTS_AT_ONCE = 16
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


class Memory:
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

    def close(self) -> None:
        self._store.close()

    def __enter__(self) -> Memory:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

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
