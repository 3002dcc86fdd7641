# SPDX-License-Identifier: Apache-2.0
"""A memory that is written: `with engram.record("robot.engram") as recorder: ...`."""

from __future__ import annotations

import os
import time as clock
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from engram import _core
from engram.closing import Closing
from engram.errors import InvalidArgumentError
from engram.times import TimeLike, to_ns


@dataclass(frozen=True)
class Update:
    """The new state of an entity, for Recorder.commit_all.

    `value` as Recorder.commit takes it.
    """

    entity: str
    value: Any
    time: TimeLike | None = None  #: None: now.
    confidence: float = 1.0  #: 0 to 1.


class Recorder(Closing):
    """The online phase: filters, compresses and stores what is committed.

    After a commit returns, what it kept survives a killed process. close() seals it into segments;
    leaving a `with` block closes. Any thread may commit; commits come one after the other.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        config: str | os.PathLike[str] | None = None,
        preset: str | None = None,
    ) -> None:
        if config is not None and preset is not None:
            raise InvalidArgumentError("found a config and a preset, needs one at most")
        self.path = os.fspath(path)
        self._store = _core.StoreRecorder(
            self.path, os.fspath(config) if config is not None else "", preset or ""
        )

    def commit(
        self, entity: str, value: Any, time: TimeLike | None = None, confidence: float = 1.0
    ) -> None:
        """Commits one snapshot. `time`: int ns since 1970, datetime64, datetime, str; None: now.

        `value`: dicts with str keys, lists, texts, bools, numbers, arrays (copied), None, and
        objects of classes that `engram idf generate --python` made. An image is a uint8 array
        (H, W, 3), best as member `image` of a dict.

        Raises InvalidArgumentError, UnavailableError, ResourceExhaustedError: then it is not
        stored, and may be tried again.
        """
        self.commit_all([Update(entity, value, time, confidence)])

    def commit_all(self, updates: Iterable[Update]) -> None:
        """Commits several snapshots as one: all of them are stored, or none."""
        self._store.commit([dict_of(update) for update in updates])

    @property
    def counts(self) -> dict[str, dict[str, Any]]:
        """Per entity of this session: "offered", "kept", "dropped_by" filters, bytes, ..."""
        return self._store.counts()

    def close(self) -> None:
        """Lets go of what filters hold and seals everything."""
        self._store.close()

    def __repr__(self) -> str:
        counts = self.counts
        lines = [f"<Recorder {self.path}: {len(counts)} entities"]
        lines += [
            f"  {entity}: {of['kept']:,} kept of {of['offered']:,}" for entity, of in counts.items()
        ]
        return "\n".join(lines) + ">"


def record(
    path: str | os.PathLike[str],
    config: str | os.PathLike[str] | None = None,
    preset: str | None = None,
) -> Recorder:
    """Opens a store for recording; makes it where there is none.

    `preset`: "recorder" (everything as it came), "balanced", "small"; `config`: a YAML file of
    docs/recording.md. Neither: everything, images without loss.
    Raises FailedPreconditionError where another process writes to it.
    """
    return Recorder(path, config, preset)


def dict_of(update: Update) -> dict[str, Any]:
    """What the C++ side takes."""
    now = clock.time_ns()
    time = now if update.time is None else to_ns(update.time)
    instance = {
        "value": update.value,
        "created": time,
        "sent": now,
        "provider": "",
        "confidence": update.confidence,
    }
    return {"entity": update.entity, "time": time, "instances": [instance]}
