# SPDX-License-Identifier: Apache-2.0
"""Where a memory is: a store that is read, or a live memory here or in a server.

Both answer the same questions, which Memory and Entity ask. Private to the package.
"""

from __future__ import annotations

import os
from typing import Any, Union

from engram import _core
from engram.errors import FailedPreconditionError, InvalidArgumentError, NotFoundError

_PREFER = {"recorded": False, "latent": True}


def prefers_latents(prefer: str) -> bool:
    if prefer not in _PREFER:
        raise InvalidArgumentError(f"prefer '{prefer}': needs 'recorded' or 'latent'")
    return _PREFER[prefer]


class StoreDoor:
    """A store as it was when it was opened, or refreshed."""

    def __init__(self, path: str, prefer: str) -> None:
        self._path = path
        self._prefers_latents = prefers_latents(prefer)
        self._store = _core.OpenStore(path)
        self.entities = self._store.entities
        self.summary = self._store.summary
        self.span = self._store.span
        self.times = self._store.times
        self.selected_times = self._store.selected_times
        self.similar = self._store.similar
        self.map = self._store.map
        self.refresh = self._store.refresh
        self._asked: _core.FrontDoor | None = None

    def select(self, entity: str, selector: str) -> list[dict[str, Any]]:
        return self._store.select(entity, selector, self._prefers_latents)

    def query(self, text: str, engine: str) -> list[tuple[str, list[dict[str, Any]]]]:
        return self._store.query(text, self._prefers_latents, engine)

    def predict(
        self, entity: str, horizons: list[int], start: int | None, engine: str, plan: str
    ) -> list[dict[str, Any]]:
        return self._store.predict(entity, horizons, start, engine, plan, self._prefers_latents)

    def engines(self, entity: str, ahead: int, start: int | None) -> list[dict[str, Any]]:
        return self._store.engines(entity, ahead, start, self._prefers_latents)

    def asked(self) -> _core.FrontDoor:
        """What answers questions in English; opened when the first is asked."""
        if self._asked is None:
            self._asked = _core.FrontDoor.read(self._path)
        return self._asked

    def close(self) -> None:
        if self._asked is not None:
            self._asked.close()
        self._store.close()

    def files(self) -> _core.OpenStore:
        """What is in files and no part of an answer: models, latents."""
        return self._store

    def live(self) -> _core.FrontDoor:
        raise FailedPreconditionError(
            f"store '{self._path}': is opened for reading alone, needs"
            " engram.open(path, read_only=False) or engram.connect(endpoint)"
        )


class LiveDoor:
    """A memory that is committed to; what is asked sees everything until then."""

    def __init__(self, front: _core.FrontDoor, place: str, path: str) -> None:
        self._front = front
        self._place = place
        self._path = path  # Empty: it has no files here.
        self.entities = front.entities
        self.summary = front.summary
        self.times = front.times
        self.selected_times = front.selected_times
        self.select = front.select
        self.query = front.query
        self.predict = front.predict
        self.similar = front.similar
        self.map = front.map
        self.close = front.close

    def span(self, entity: str) -> tuple[int, int]:
        try:
            return self._front.span(entity)
        except NotFoundError:
            names = ", ".join(self._front.entities()[:20]) or "nothing"
        raise NotFoundError(f"{self._place} has no entity '{entity}'; it has: {names}")

    def engines(self, entity: str, ahead: int, start: int | None) -> list[dict[str, Any]]:
        return self._front.engines(entity, ahead, start)

    def refresh(self) -> None:
        """Nothing: it sees everything."""

    def files(self) -> _core.OpenStore:
        """Opened anew: a night may have published a model meanwhile."""
        if self._path:
            return _core.OpenStore(self._path)
        raise FailedPreconditionError(
            f"{self._place}: has no files here, needs engram.open(path) of its store"
        )

    def live(self) -> _core.FrontDoor:
        return self._front

    def asked(self) -> _core.FrontDoor:
        return self._front


Door = Union[StoreDoor, LiveDoor]


def text_of(what: str, found: object) -> str:
    """A text or a path. Raises InvalidArgumentError for anything else."""
    if isinstance(found, (str, os.PathLike)):
        path = os.fspath(found)
        if isinstance(path, str):
            return path
    raise InvalidArgumentError(f"{what}: found {found!r} of type {type(found).__name__}, needs str")
