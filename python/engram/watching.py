# SPDX-License-Identifier: Apache-2.0
"""What a memory tells of as it is committed: `for event in memory.watch("Objects"): ...`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

from engram import _core
from engram.closing import Closing
from engram.idf.value import Value
from engram.snapshot import Snapshot, snapshot_of
from engram.times import DurationLike, duration_ns


@dataclass(frozen=True, eq=False)  # Arrays have no one truth.
class Event:
    """A commit that a watch was told of."""

    snapshot: Snapshot  #: As it was committed; without data its values are None.
    has_data: bool  #: Else query(f"{entity} @ {time}") has it.
    lost: int  #: So many before it were not told: this watch was too slow.
    interruption: str  #: Why others may be missing before it: the server was lost; else empty.

    @property
    def entity(self) -> str:
        return self.snapshot.entity

    @property
    def time(self) -> int:
        """ns since 1970, UTC."""
        return self.snapshot.time

    @property
    def value(self) -> Value:
        """Of the first instance; None without data."""
        return self.snapshot.value


class Watch(Closing):
    """Events from the moment that it was made, in the order of the commits of each entity.

        with memory.watch("Objects", data=True) as watch:
            for event in watch:
                print(event.entity, event.value)

    Iteration waits for events, and ends where `timeout` seconds pass without one, where the watch
    or the memory is closed, and at Ctrl-C. It may go on after a timeout or a `break`: what comes
    meanwhile waits, up to 1,024 events or `queue`; then the oldest go, and are counted.

    Threading: any thread may take events, each of which one thread gets, and any may close. Other
    threads of Python run while one waits. A forked process begins a watch of its own.
    """

    def __init__(self, watch: _core.Watch, timeout: DurationLike | None) -> None:
        self._watch = watch
        self._timeout = timeout

    def next(self, timeout: DurationLike | None = None) -> Event | None:
        """The next event; None where none comes within `timeout` seconds, or where it is closed.

        Without a timeout it waits on; 0 does not wait. Raises KeyboardInterrupt at Ctrl-C.
        """
        found = self._watch.next(None if timeout is None else max(0, duration_ns(timeout)))
        return None if found is None else _event_of(found)

    def __iter__(self) -> Self:
        return self

    def __next__(self) -> Event:
        event = self.next(self._timeout)
        if event is None:
            raise StopIteration
        return event

    @property
    def lost(self) -> int:
        """So many events were not told until now, because this watch was too slow."""
        return self._watch.lost()

    @property
    def interruptions(self) -> int:
        """So often the server was lost. It is subscribed to again by itself."""
        return self._watch.interruptions()

    @property
    def is_closed(self) -> bool:
        return self._watch.is_closed()

    def close(self) -> None:
        """Ends it; what waits is dropped, and who iterates stops. Closing twice is fine."""
        self._watch.close()


def _event_of(found: dict[str, Any]) -> Event:
    return Event(snapshot=snapshot_of(found.pop("snapshot")), **found)
