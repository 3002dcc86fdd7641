# SPDX-License-Identifier: Apache-2.0
"""What a program of the robot can do: `@engram.skill` and `engram.provide`."""

from __future__ import annotations

import datetime
import inspect
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from engram import _core, idf
from engram.closing import Closing
from engram.doors import text_of
from engram.errors import (
    FailedPreconditionError,
    InvalidArgumentError,
    NotFoundError,
    UnavailableError,
)
from engram.idf.value import Value
from engram.times import DurationLike, duration_ns

if TYPE_CHECKING:
    from engram.memory import Memory

_OUTCOMES = {"success": 1, "failure": 2, "stop": 3}
_ENDS = {**{number: name for name, number in _OUTCOMES.items()}, 4: "lost"}


class SkillFailure(Exception):
    """Raised by a skill that has failed; the message is the reason. Any exception is a failure, too."""


@dataclass(frozen=True)
class SkillEnd:
    """How an execution ended, for skills that have more to say than a reason."""

    reason: str = ""  #: What was measured, in words.
    outcome: str = "success"  #: Or "failure", "stop".
    result: Any = field(default_factory=dict)  #: A value of IDF: what came out, for programs.
    links: tuple[str, ...] = ()  #: IDs of what it made or found in the memory.


class SkillRun:
    """One execution of a skill, for the function that carries it out, and no longer."""

    def __init__(self, run: _core.SkillRun) -> None:
        self._run = run

    @property
    def parameters(self) -> dict[str, Value]:
        """All parameters: those that were not given have their defaults."""
        return self._run.parameters()

    @property
    def is_stopped(self) -> bool:
        """Whether it is to stop. The function then ends soon; its outcome is `stop`."""
        return self._run.is_stopped()

    @property
    def stop_reason(self) -> str:
        """Why it is to stop; empty: it is not."""
        return self._run.stop_reason()

    @property
    def execution(self) -> str:
        """ID of the event at which it started, for links in what it commits."""
        return self._run.execution()

    @property
    def request(self) -> str:
        """ID of the request."""
        return self._run.request()

    def wait(self, seconds: DurationLike) -> bool:
        """Waits; True as soon as it is to stop. Other threads of Python run meanwhile."""
        return self._run.wait(max(0, duration_ns(seconds)))

    def report(self, value: Value, links: Iterable[str] = ()) -> None:
        """Reports something on the way. Raises UnavailableError where the server is gone."""
        self._run.report(value, list(links))


@dataclass(frozen=True)
class Skill:
    """A function with the description of the skill that it carries out; see `skill`."""

    description: str
    function: Callable[..., Any]

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        return self.function(*arguments, **named)


def skill(description: str) -> Callable[[Callable[..., Any]], Skill]:
    """Makes a skill of a function; `description` is YAML (docs/skills.md), or the name of a skill
    that is known before.

        @engram.skill("name: wave\\nparameters: {times: {type: int, default: 3}}")
        def wave(run, times):
            for i in range(times):
                if run.wait(0.5):
                    return
            return f"waved {times} times"

    The function gets the SkillRun and the parameters by name. It returns the reason as a text, None,
    or a SkillEnd; if it was to stop, its outcome is `stop`. An exception is a failure.
    """
    text = text_of("description", description)

    def made(function: Callable[..., Any]) -> Skill:
        if not callable(function):
            raise InvalidArgumentError(f"skill: found {function!r}, needs a function")
        return Skill(text, function)

    return made


class SkillProvider(Closing):
    """A program that has skills. It connects again by itself when the server was gone; what ran
    then is stopped.

        with engram.SkillProvider("arm") as provider:
            provider.add(wave)
            provider.wait()

    Raises AlreadyExistsError where another provider has the name; UnavailableError where no server
    answers until `timeout` seconds; FailedPreconditionError where the server has no skill memory.
    Threading: any thread. Each execution runs in a thread of its own.
    """

    def __init__(
        self,
        name: str,
        endpoint: str = "",
        *,
        is_name_system: bool = False,
        token: str = "",
        ca: str = "",
        timeout: DurationLike = 10,
    ) -> None:
        if not hasattr(_core, "SkillProvider"):
            raise FailedPreconditionError("skills: the module was built without servers")
        self._provider = _core.SkillProvider(
            text_of("endpoint", endpoint),
            text_of("name", name),
            token,
            text_of("ca", ca),
            duration_ns(timeout),
            is_name_system,
        )

    def add(self, skill: Skill) -> None:
        """Adds a skill; returns once it can be executed. Raises InvalidArgumentError naming line and
        key of its description; AlreadyExistsError."""
        if not isinstance(skill, Skill):
            raise InvalidArgumentError(
                f"found {skill!r} of type {type(skill).__name__}, needs what @engram.skill made"
            )
        self._provider.add(skill.description, _carried_out_by(skill.function))

    def remove(self, name: str) -> None:
        """Removes a skill; what runs of it goes on. Raises NotFoundError."""
        self._provider.remove(name)

    @property
    def running(self) -> int:
        """How many executions run now."""
        return self._provider.running()

    def wait(self) -> None:
        """Waits for ever: until Ctrl-C, which raises KeyboardInterrupt."""
        while True:
            time.sleep(3600)

    def close(self) -> None:
        """Stops what runs, waits for it, and leaves. Closing twice is fine."""
        self._provider.close()


def provide(name: str, *skills: Skill, endpoint: str = "", **options: Any) -> None:
    """Has these skills until Ctrl-C: the main program of a provider. `options`: those of
    SkillProvider."""
    with SkillProvider(name, endpoint, **options) as provider:
        for one in skills:
            provider.add(one)
        try:
            provider.wait()
        except KeyboardInterrupt:
            pass


@dataclass(frozen=True)
class SkillResult:
    """How a request for a skill ended."""

    request: str  #: ID of the request.
    outcome: str  #: "success", "failure", "stop", "lost" or "refused".
    reason: str  #: In words.
    result: Value  #: What came out; None where it was refused.
    end: str  #: ID of the event, or of the refusal, that says so.

    def __bool__(self) -> bool:
        return self.outcome == "success"


def run_skill(
    memory: Memory,
    skill: str,
    parameters: dict[str, Any] | None = None,
    *,
    wait: DurationLike = 0,
    version: str = "",
    causes: Iterable[str] = (),
    requester: str = "python",
    timeout: DurationLike = 10,
) -> SkillResult:
    """Asks for a skill and waits until it has ended; Ctrl-C asks to stop it and raises.

    `skill`: "PROVIDER/SKILL", or "SKILL" if only one provider has it. `wait`: how long the request
    may wait for conditions and resources. `causes`: IDs of why it is wanted. Raises UnavailableError
    where nothing answers within `timeout` seconds.
    """
    name = skill.rsplit("/", 1)[-1]
    entity = f"Skill/ExecutionRequest/{requester}/{name}"
    wanted: dict[str, Any] = {
        "skill": skill,
        "wish": 0,
        "parameters": idf.to_json(parameters or {}),
        "wait": duration_ns(wait) / 1e9,
        "version": version,
        "execution": None,
        "causes": list(causes),
    }
    with memory.watch(["Skill/Event", "Skill/Refusal"]) as watch:
        now = time.time_ns()
        request = f"{entity}/{_printed(now)}/0"
        memory.commit(entity, wanted, now)
        is_heard, missed, look_again = False, 0, 0.0
        give_up = time.monotonic() + (duration_ns(wait) + duration_ns(timeout)) / 1e9
        try:
            while True:
                event = watch.next(0.1)
                # Values are objects of the types of the skill memory.
                found: list[tuple[str, int, Any]] = []
                if event is not None:
                    found.append((event.entity, event.time, event.value))
                missed = max(missed, watch.lost + watch.interruptions)
                # A server that was away tells nobody what came meanwhile.
                if missed and time.monotonic() > look_again:
                    look_again = time.monotonic() + 1
                    found += _said_lately(memory)
                if not found:
                    if not is_heard and time.monotonic() > give_up:
                        raise UnavailableError(
                            f"skill '{skill}': no answer: does a server with the memory Skill run?"
                        )
                    continue
                for where, when, value in found:
                    if value["request"] != request:
                        continue
                    is_heard = True
                    at = f"{where}/{_printed(when)}/0"
                    if "unmet" in value:
                        return SkillResult(request, "refused", value["reason"], None, at)
                    if value["stage"] == 2:
                        result = idf.from_json(value["result"]) if value["result"] else None
                        end = _ENDS[value["outcome"]]
                        return SkillResult(request, end, value["reason"], result, at)
        except KeyboardInterrupt:
            stop = {**wanted, "wish": 1, "parameters": "{}", "execution": request}
            memory.commit(entity, stop, time.time_ns())
            raise


def _said_lately(memory: Memory) -> list[tuple[str, int, Any]]:
    """What became of requests in the last hour; nothing while the server is away."""
    try:
        answer = memory.query("Skill/Event @ last:1h ; Skill/Refusal @ last:1h")
    except (NotFoundError, UnavailableError):
        return []
    return [(one.entity, one.time, one.value) for all_of in answer.values() for one in all_of]


def _printed(time_ns: int) -> str:
    """A time as it is in IDs: with six digits, or nine where it needs them."""
    seconds, ns = divmod(time_ns, 10**9)
    digits = f"{ns // 1000:06d}" if ns % 1000 == 0 else f"{ns:09d}"
    at = datetime.datetime.fromtimestamp(seconds, datetime.timezone.utc)
    return f"{at:%Y-%m-%d %H:%M:%S}.{digits}"


def _carried_out_by(function: Callable[..., Any]) -> Callable[[Any], tuple[Any, ...]]:
    # A function that takes no parameters of the skill may leave them out.
    takes = inspect.signature(function).parameters
    takes_all = any(one.kind is inspect.Parameter.VAR_KEYWORD for one in takes.values())

    def carry_out(bound: Any) -> tuple[Any, ...]:
        run = SkillRun(bound)
        given = run.parameters
        named = given if takes_all else {key: given[key] for key in given if key in takes}
        try:
            end = function(run, **named)
        except SkillFailure as failure:
            end = SkillEnd(str(failure), "failure")
        except Exception as failure:  # noqa: BLE001: whatever it is, the skill has failed by it.
            end = SkillEnd(f"{type(failure).__name__}: {failure}", "failure")
        if not isinstance(end, SkillEnd):
            end = SkillEnd("" if end is None else str(end), "stop" if run.is_stopped else "success")
        if end.outcome not in _OUTCOMES:
            end = SkillEnd(f"outcome '{end.outcome}': needs one of {', '.join(_OUTCOMES)}", "failure")
        return _OUTCOMES[end.outcome], end.reason, end.result, list(end.links)

    return carry_out
