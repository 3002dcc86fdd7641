# SPDX-License-Identifier: Apache-2.0
"""A store as the memory that it was: `engram.replay("robot.engram", at=..., speed=2)`."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from engram import _core
from engram.doors import LiveDoor, text_of
from engram.errors import FailedPreconditionError, InvalidArgumentError, NotFoundError
from engram.times import TimeLike, to_ns

if TYPE_CHECKING:
    from engram.memory import Memory

_CLOCK = "SystemState/Replay/engram/clock"
_CONTROL = "SystemState/Replay/engram/control"


@dataclass(frozen=True)
class ReplayState:
    """What a replay says of itself. Times are ns since 1970, UTC."""

    stores: tuple[str, ...]  #: What is replayed.
    now: int  #: The replayed moment; up to a second old while it plays.
    speed: float  #: Replayed seconds per second.
    is_playing: bool
    loop: tuple[int, int] | None  #: The part that is repeated.
    first: int  #: Of the first and the last snapshot that was recorded.
    last: int
    jumps: int  #: How often it was set to another moment, loops included.
    told: int  #: Recorded snapshots that its clock passed.
    unreadable: int  #: Of these, those that nobody was told of: damaged, or forgotten meanwhile.
    scored: int  #: Predictions that were compared with what came,
    bounded: int  #: those of them that had a bound,
    within_bound: int  #: and those that kept it.
    unscored: int  #: Predictions that nothing came for.


class Replaying:
    """Controls the replay behind a memory: one of engram.replay, or that of a server.

    Once a call returns, all that is asked of the memory is of the new moment. Each raises
    FailedPreconditionError where the memory is no replay, and InvalidArgumentError.
    """

    def __init__(self, memory: Memory) -> None:
        self._memory = memory

    @property
    def state(self) -> ReplayState:
        """What the replay says of itself."""
        try:
            found = self._memory.query(f"{_CLOCK} @ latest")
        except NotFoundError:
            found = {}
        if not found.get(_CLOCK):
            raise FailedPreconditionError(f"{self._memory!r}: is no replay: has no '{_CLOCK}'")
        value = found[_CLOCK][-1].value
        if not isinstance(value, dict):
            raise InvalidArgumentError(f"'{_CLOCK}': found {value!r}, needs a dict")
        told: dict[str, Any] = dict(value)
        loop = told["loop"]
        told["loop"] = None if loop is None else (int(loop["first"]), int(loop["last"]))
        told["stores"] = tuple(told["stores"])
        return ReplayState(**told)

    def play(self) -> None:
        self._tell(command="play")

    def pause(self) -> None:
        self._tell(command="pause")

    def step(self) -> None:
        """Pauses, and goes on to the next commit that was recorded.

        Raises NotFoundError behind the last one.
        """
        self._tell(command="step")

    def seek(self, time: TimeLike) -> None:
        """Goes to a moment. What was committed after it is taken back."""
        self._tell(command="seek", time=to_ns(time))

    def set_speed(self, speed: float) -> None:
        """Replayed seconds per second, from 0.001 to 1000."""
        self._tell(command="speed", speed=float(speed))

    def repeat(self, first: TimeLike | None = None, last: TimeLike | None = None) -> None:
        """Repeats a part; without times ends that."""
        if first is None and last is None:
            self._tell(command="loop")
            return
        if first is None or last is None:
            raise InvalidArgumentError("repeat: found one time, needs the first and the last")
        self._tell(command="loop", first=to_ns(first), last=to_ns(last))

    def _tell(self, **command: Any) -> None:
        _ = self.state  # A robot would take the command for a snapshot like any other.
        self._memory.commit(_CONTROL, command, durability="memory")


def replay(
    path: str | os.PathLike[str],
    at: TimeLike | None = None,
    *,
    speed: float = 1,
    paused: bool = False,
    loop: tuple[TimeLike, TimeLike] | None = None,
) -> Memory:
    """Opens a store as the memory that it was at a moment, on a clock of its own.

    Whoever asks it is answered as it was then: `latest` is the last before the replayed moment, and
    predictions are made although the future is known. Watches are told what came, in the recorded
    order. What is committed is there until it jumps to a moment before, or is closed; nothing is
    written to the store. `memory.replaying` controls it.

    `at`: the moment to begin with; None: that of the first snapshot. `speed`: replayed seconds per
    second, 0.001 to 1000. `paused`: stand still at first. `loop`: repeat this part.

    Raises InvalidArgumentError where `at` lies before the first snapshot; NotFoundError;
    DataLossError.
    """
    from engram.memory import Memory

    place = text_of("store", path)
    part = None if loop is None else (to_ns(loop[0]), to_ns(loop[1]))
    front = _core.FrontDoor.replay(
        place, None if at is None else to_ns(at), float(speed), bool(paused), part
    )
    memory = Memory(place, door=LiveDoor(front, f"replay of '{place}'", place))
    memory._reopen = None
    return memory
