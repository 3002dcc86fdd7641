# SPDX-License-Identifier: Apache-2.0
"""One memory behind every door: a store that is read, a live memory here, or one of a server."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from engram import _core
from engram.closing import Closing
from engram.doors import Door, LiveDoor, StoreDoor, prefers_latents, text_of
from engram.entity import Entity
from engram.errors import FailedPreconditionError, InvalidArgumentError
from engram.idf.type_table import type_to_data
from engram.idf.typed import TypedObject
from engram.idf.types import Type
from engram.model import Model
from engram.recording import Update, dict_of
from engram.replaying import Replaying
from engram.snapshot import Snapshot, snapshot_of
from engram.speech import Answer, Told, answer_of, told_of
from engram.times import DurationLike, TimeLike, duration_ns, to_ns
from engram.viewing import View, view
from engram.watching import Watch

__all__ = ["Entity", "Memory", "connect", "open"]

_WORKING_BYTES = 512 << 20


class Memory(Closing):
    """What engram.open and engram.connect give; the same questions have the same answers.

    It is a store that is read (any number may, beside one that writes), a live memory that this
    program opened (`read_only=False`), or one of a server (engram.connect). The last two are
    committed to and watched.

    What is answered stays valid when the memory is closed; images and arrays are views that keep
    their owner. Any thread may ask, and other threads of Python run meanwhile; a store that is read
    answers one after the other, a live memory several at once. A memory does not survive a fork.
    """

    def __init__(
        self, path: str | os.PathLike[str], prefer: str = "recorded", *, door: Door | None = None
    ) -> None:
        """Opens a store for reading, as engram.open does. `door`: of engram.open and connect."""
        self.path = os.fspath(path)  #: Of its store; empty where it is in a server.
        self.endpoint = ""  #: Of its server; empty where there is none, or it is the usual one.
        self._prefer = prefer
        self._reopen: tuple[Any, ...] | None = (Memory, (self.path, prefer))
        self._door = StoreDoor(self.path, prefer) if door is None else door

    @property
    def entities(self) -> list[str]:
        """Their names, "Memory/Core/Provider/Entity", in order."""
        return self._door.entities()

    def __getitem__(self, name: str) -> Entity:
        """Raises NotFoundError, which lists what there is."""
        self._door.span(name)
        return Entity(self._door, name)

    def __contains__(self, name: object) -> bool:
        return name in self.entities

    def __iter__(self) -> Iterator[Entity]:
        return (Entity(self._door, name) for name in self.entities)

    def __len__(self) -> int:
        return len(self.entities)

    def query(self, text: str, engine: str = "") -> dict[str, list[Snapshot]]:
        """The answer to a query in its text form (docs/query.md), by entity.

        `engine`: of predictions, by its name; empty: the best on the past of each entity.
        Raises NotFoundError where no entity matches; InvalidArgumentError naming what cannot be
        read, or where a prediction is asked too far ahead; of a server also UnavailableError,
        after its timeout.
        """
        found = self._door.query(text, engine)
        return {entity: [snapshot_of(one) for one in snapshots] for entity, snapshots in found}

    def commit(
        self,
        entity: str,
        value: Any,
        time: TimeLike | None = None,
        confidence: float = 1.0,
        *,
        durability: str = "default",
    ) -> None:
        """Remembers one snapshot of a live memory; the rest as Recorder.commit.

        After it returns the snapshot can be asked for, and survives a killed process where
        `durability` is "journal", the default of a memory that this program opened. "memory" is
        quicker: it may be lost until working memory hands it to the store. The default of a server
        is what it is configured for.

        Raises InvalidArgumentError naming every path where the value is not of its segment's type;
        ResourceExhaustedError; FailedPreconditionError where it is opened for reading alone;
        UnavailableError of a server: it may have arrived or not, and may be committed again.
        """
        self.commit_all([Update(entity, value, time, confidence)], durability=durability)

    def commit_all(self, updates: Iterable[Update], *, durability: str = "default") -> None:
        """Commits several snapshots as one: all of them are remembered, or none."""
        live = self._door.live()
        live.commit([dict_of(update) for update in updates], text_of("durability", durability))

    def declare(self, segment: str, of: Type | type[TypedObject]) -> None:
        """Says what the values of a core segment (two names) or provider segment (three) are.

        `of`: a type, or a class that `engram idf generate --python` made. Commits are cast to it
        where possible, and refused where not.
        Raises InvalidArgumentError, also where a provider's type does not extend the core type.
        """
        live = self._door.live()
        if isinstance(of, type) and issubclass(of, TypedObject):
            of = of.idf_type()
        if not isinstance(of, Type):
            raise InvalidArgumentError(
                f"type of '{segment}': found {of!r}, needs an engram.idf.Type or a generated class"
            )
        live.declare(text_of("segment", segment), type_to_data(of))

    def watch(
        self,
        names: str | Sequence[str] = (),
        *,
        data: bool = True,
        timeout: DurationLike | None = None,
        max_bytes: int = 0,
        queue: int = 0,
    ) -> Watch:
        """Tells of commits from now on, those of this program included; returns when it does.

        `names`: of entities as in queries ("Vision/.*/head/cam"); none: all. `data`: with values;
        `max_bytes`: larger ones without; 0: no limit. `timeout`: iteration ends after so many
        seconds without an event. `queue`: how many may wait; 0: 1,024.
        Raises InvalidArgumentError naming the pattern; FailedPreconditionError where it is opened
        for reading alone; UnavailableError.
        """
        patterns = [names] if isinstance(names, str) else list(names)
        for name, number in (("max_bytes", max_bytes), ("queue", queue)):
            if not isinstance(number, int) or not 0 <= number < 2**32:
                raise InvalidArgumentError(f"watch: found {name} {number!r}, needs an int from 0")
        told = self._door.live().watch(
            [text_of("name", one) for one in patterns], bool(data), max_bytes, queue
        )
        return Watch(told, timeout)

    def ask(
        self, question: str, *, now: TimeLike | None = None, is_program: bool = False
    ) -> Answer:
        """Answers a question in English about what the robot did, saw and was told, and why.

        What the memory does not tell is "unknown", with what was looked for; so is what could not
        be read. `now`: when it is asked, which "yesterday" counts from; without it the last moment
        of a store that is read, else that of the clock. `is_program`: the question is a program
        (docs/verbalisation.md). Raises InvalidArgumentError for one that does not validate.
        """
        when = None if now is None else to_ns(now)
        return answer_of(self._door.asked().ask(question, when, is_program))

    def tell(
        self,
        since: str = "today",
        until: str = "now",
        *,
        now: TimeLike | None = None,
        sentences: int = 10,
    ) -> list[Told]:
        """Tells what the robot did in a time, in a few sentences with links.

        Times are those of programs: "yesterday", "today/morning", "2026-01-02/08:05", "now-10m".
        """
        when = None if now is None else to_ns(now)
        return told_of(self._door.asked().tell(since, until, when, sentences))

    @property
    def replaying(self) -> Replaying:
        """Controls the replay that this memory is: of engram.replay, or of `engram replay`."""
        return Replaying(self)

    def view(
        self,
        *,
        notebook: str = "http://localhost:8888",
        height: int = 640,
        program: str | None = None,
        options: Sequence[str] = (),
    ) -> View:
        """Opens the viewer (docs/viewer.md): a notebook shows it in a frame, a browser at its `url`.

        `notebook`: the origin that the notebook is served from, which alone may show it in a frame.
        `height`: of the frame, in pixels. `program`: where `engram` is, if it is neither on the PATH
        nor where the package was built. `options`: more of `engram view`, such as `["--noted"]`.

        Raises NotFoundError without the program, FailedPreconditionError with what it says.
        """
        return view(self, notebook, height, program, options)

    def models(self) -> list[Model]:
        """All models, older ones first. Of a server FailedPreconditionError: its files have them."""
        return [Model(**one) for one in self._door.files().models()]

    def refresh(self) -> None:
        """Sees what was committed, learned or forgotten since it was opened; a live memory does."""
        self._door.refresh()

    def close(self) -> None:
        """Ends watches, too. A live memory hands what it holds to its store and seals it.

        Raises what the store refused then.
        """
        self._door.close()

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled by path or endpoint: another process opens it anew."""
        if self._reopen is None:
            raise FailedPreconditionError(
                f"{self!r}: is not pickled: a store is written by one process, tokens stay secret"
            )
        return self._reopen

    def __repr__(self) -> str:
        if not isinstance(self._door, StoreDoor):
            return f"<Memory {self.path or self.endpoint or 'of the usual server'}: live>"
        entities = list(self)
        lines = [f"<Memory {self.path}: {len(entities)} entities"]
        lines += [f"  {entity!r}" for entity in entities[:20]]
        if len(entities) > 20:
            lines.append(f"  and {len(entities) - 20} more")
        return "\n".join(lines) + ">"


def open(  # noqa: A001
    path: str | os.PathLike[str],
    prefer: str = "recorded",
    *,
    read_only: bool = True,
    working_bytes: int = _WORKING_BYTES,
    horizon: DurationLike = 60,
    config: str | os.PathLike[str] | None = None,
) -> Memory:
    """Opens a store: for reading, or with `read_only=False` as a live memory.

    `prefer` is "recorded" or "latent": which form answers where a moment has both. A live memory is
    made where there is none, and one process at a time has it. For it alone: `working_bytes` may
    stay in working memory; predictions reach at most `horizon` seconds; `config` is a YAML file of
    docs/recording.md, without one everything is kept as it came.

    Raises NotFoundError where there is none to read, DataLossError, FailedPreconditionError (a
    newer format; another process writes to it), InvalidArgumentError.
    """
    if read_only:
        return Memory(text_of("store", path), prefer)
    place = text_of("store", path)
    if not isinstance(working_bytes, int) or working_bytes < 0:
        raise InvalidArgumentError(f"working_bytes {working_bytes!r}: needs an int from 0")
    settings = "" if config is None else text_of("config", config)
    front = _core.FrontDoor.open(
        place, working_bytes, prefers_latents(prefer), duration_ns(horizon), settings
    )
    memory = Memory(place, prefer, door=LiveDoor(front, f"store '{place}'", place))
    memory._reopen = None
    return memory


def connect(
    endpoint: str = "",
    *,
    token: str = "",
    ca: str | os.PathLike[str] | None = None,
    timeout: DurationLike = 10,
) -> Memory:
    """Reaches the memory server at an endpoint: "unix:/run/engram.sock", "head.local:4817".

    Empty: where this user's server listens by default. It does not wait for the server: calls do,
    `timeout` seconds each, retries included; Ctrl-C is seen when a call returns, and at once where
    a watch waits. `token`: who asks (docs/access.md). `ca`: a PEM file, who vouches for servers on
    other machines.

    Raises InvalidArgumentError; FailedPreconditionError where the module was built without servers.
    """
    place, authority = text_of("endpoint", endpoint), "" if ca is None else text_of("ca", ca)
    longest = duration_ns(timeout)
    if longest <= 0:
        raise InvalidArgumentError(f"timeout {timeout!r}: needs more than zero seconds")
    front = _core.FrontDoor.connect(place, text_of("token", token), authority, longest)
    memory = Memory("", door=LiveDoor(front, f"server '{place}'" if place else "the server", ""))
    memory.endpoint = place
    memory._reopen = None if token else (_connected, (place, authority, longest))
    return memory


def _connected(endpoint: str, ca: str, timeout: int) -> Memory:
    return connect(endpoint, ca=ca or None, timeout=timeout / 1e9)
