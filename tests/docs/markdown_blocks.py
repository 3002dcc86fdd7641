# SPDX-License-Identifier: Apache-2.0
"""The code blocks of a Markdown document, and what the comments above them order."""

from __future__ import annotations

import pathlib
import re
from dataclasses import dataclass, field

LANGUAGES = ("sh", "python", "yaml", "json", "xml", "cpp", "cmake", "ini", "text")

_FENCE = re.compile(r"^( *)(`{3,}|~{3,})\s*([^`\s]*)\s*$")
_LIST_ITEM = re.compile(r"^\s*([*+-]|\d+[.)])\s")


class DocumentError(Exception):
    """A document says something that cannot be carried out; the message begins with its place."""


@dataclass
class Orders:
    """What a comment above a block says of it. Source: docs/writing.md."""

    reason_not_to_run: str = ""
    setups: list[tuple[str, str]] = field(default_factory=list)  #: (fixture, path in the folder)
    before: list[str] = field(default_factory=list)
    after: list[str] = field(default_factory=list)
    replaced: list[tuple[str, str]] = field(default_factory=list)
    file: str = ""  #: The block is saved there first.
    exit_code: int = 0
    ready: str | None = None  #: Runs in the background from the moment that it has said this.
    is_shown: bool = False  #: Text that the blocks above have printed.


@dataclass
class Block:
    document: str
    line: int  #: Of the first line inside, from 1.
    language: str
    text: str
    orders: Orders

    @property
    def place(self) -> str:
        return f"{self.document}:{self.line - 1}"


def blocks_of(path: pathlib.Path, name: str) -> list[Block]:
    """All code blocks of a document, in order. Raises DocumentError."""
    lines = path.read_text().split("\n")
    blocks: list[Block] = []
    orders = Orders()
    has_orders = in_list = False
    at = 0
    while at < len(lines):
        line = lines[at]
        if line.lstrip().startswith("<!--"):
            comment, at = _comment(lines, at, name)
            has_orders |= _read_orders(comment, orders, f"{name}:{at}")
            continue
        if fence := _FENCE.match(line):
            end = _end_of(lines, at, fence)
            if end is None:
                raise DocumentError(f"{name}:{at + 1}: this block has no end")
            indent = len(fence[1])
            text = "\n".join(one[min(indent, len(one) - len(one.lstrip())):]
                             for one in lines[at + 1 : end])
            blocks.append(Block(name, at + 2, fence[3], text + "\n", orders))
            orders, has_orders, at = Orders(), False, end + 1
            continue
        if line.strip():
            if has_orders:
                raise DocumentError(f"{name}:{at + 1}: orders stand above, and no block follows")
            _refuse_indented(lines, at, in_list, name)
            if _LIST_ITEM.match(line):
                in_list = True
            elif not line.startswith(" "):
                in_list = False
        at += 1
    if has_orders:
        raise DocumentError(f"{name}: the last comment gives orders, and no block follows")
    return blocks


def _end_of(lines: list[str], start: int, fence: re.Match[str]) -> int | None:
    for at in range(start + 1, len(lines)):
        text = lines[at].strip()
        if text.startswith(fence[2]) and not text.strip(fence[2][0]):
            return at
    return None


def _refuse_indented(lines: list[str], at: int, in_list: bool, name: str) -> None:
    """Indented blocks say no language, so nobody would know what to do with them."""
    follows_blank = at == 0 or not lines[at - 1].strip()
    if follows_blank and lines[at].startswith(" " * (8 if in_list else 4)):
        raise DocumentError(
            f"{name}:{at + 1}: an indented code block; needs a fence and a language")


def _comment(lines: list[str], at: int, name: str) -> tuple[str, int]:
    """The text of a comment, and the line behind it."""
    text = []
    for end in range(at, len(lines)):
        text.append(lines[end])
        if lines[end].rstrip().endswith("-->"):
            return "\n".join(text).strip().removeprefix("<!--").removesuffix("-->").strip(), end + 1
    raise DocumentError(f"{name}:{at + 1}: this comment has no end")


def _read_orders(comment: str, orders: Orders, place: str) -> bool:
    """Adds what a comment orders; False where it is a remark."""
    if comment.startswith("not run:"):
        orders.reason_not_to_run = " ".join(comment.removeprefix("not run:").split())
        if not orders.reason_not_to_run:
            raise DocumentError(f"{place}: 'not run' needs a reason")
        return True
    if not comment.startswith("run:"):
        return False
    for line in comment.removeprefix("run:").split("\n"):
        if line.strip():
            _read_order(line.rstrip(), orders, place)
    return True


def _read_order(line: str, orders: Orders, place: str) -> None:
    word, _, rest = line.strip().partition(" ")
    if word == "setup" and rest:
        fixture, _, target = rest.partition(" as ")
        orders.setups.append((fixture.strip(), (target or fixture).strip()))
    elif word == "before":
        orders.before.append(rest)
    elif word == "after":
        orders.after.append(rest)
    elif word == "write" and rest:
        orders.file = rest
    elif word == "exits" and rest.isdecimal():
        orders.exit_code = int(rest)
    elif word == "background":
        orders.ready = rest.removeprefix("until ")
    elif word == "shown" and not rest:
        orders.is_shown = True
    elif word == "replace" and " => " in rest:
        old, _, new = rest.partition(" => ")
        orders.replaced.append((old.strip(), new.strip()))
    else:
        raise DocumentError(f"{place}: unknown order '{line.strip()}'")
