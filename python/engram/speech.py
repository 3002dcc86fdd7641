# SPDX-License-Identifier: Apache-2.0
"""Answers in English: what Memory.ask and Memory.tell give."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

__all__ = ["Answer", "Evidence", "Told"]


@dataclass(frozen=True)
class Evidence:
    """An instance that an answer was read from."""

    id: str
    role: str  #: "started", "ended", "request", "plan", "words", "thing", "looked at", ...


@dataclass(frozen=True)
class Answer:
    """An answer with what it rests on (docs/verbalisation.md)."""

    question: str
    text: str  #: The answer as a sentence.
    kind: str  #: "yes_no", "count", "time", "span", "seconds", "metres", "names", ... or "unknown".
    #: True or False, a number, a time as text, names, IDs of events or the words of a reason; of a
    #: span its two times; None where it is unknown.
    value: Any
    route: str  #: "program"; "none" where the question could not be read.
    confidence: float  #: How well the question was read, 0 to 1.
    program: str | None  #: The question as a program.
    evidence: list[Evidence]
    looked_for: str  #: What was looked for, and what was missing.
    took_ms: float

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class Told:
    """One sentence of what a robot did."""

    level: str  #: "whole", "plan" or "failure"; each is below the one before.
    text: str
    links: list[str]  #: The instances that it was read from.

    def __str__(self) -> str:
        return self.text


def answer_of(text: str) -> Answer:
    found = json.loads(text)
    value = found.pop("value")
    kind = value.pop("kind")
    read = (value["from"], value["to"]) if kind == "span" else value.get("value")
    evidence = [Evidence(**one) for one in found.pop("evidence")]
    return Answer(kind=kind, value=read, evidence=evidence, **found)


def told_of(text: str) -> list[Told]:
    return [Told(**one) for one in json.loads(text)]
