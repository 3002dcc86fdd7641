# SPDX-License-Identifier: Apache-2.0
"""Runs the blocks of one document, in their order, in a folder of its own."""

from __future__ import annotations

import collections
import pathlib
import re
from dataclasses import dataclass, field

from checked_languages import check_cmake, check_cpp, check_data, flags_of
from fixtures import Fixtures
from markdown_blocks import LANGUAGES, Block, DocumentError, blocks_of
from python_session import PythonSession
from sandbox import BlockError, Sandbox

_COMMAND = re.compile(r"^\s*(engram|make|cmake|sudo|systemctl|pip|python3?)\s", re.MULTILINE)
_FIGURE = re.compile(r"[-+]?\d[\d.,:]*(?: ?[kMG]?B\b)?")  #: With bytes: 536 kB or 2.7 MB.


@dataclass(frozen=True)
class Tools:
    """What blocks need. Without `python_path` those in Python are left out, and counted."""

    engram: pathlib.Path
    source: pathlib.Path
    python_path: str
    compile_commands: pathlib.Path


@dataclass
class DocumentReport:
    name: str
    counts: collections.Counter[str] = field(default_factory=collections.Counter)
    left_out: list[str] = field(default_factory=list)
    failures: list[str] = field(default_factory=list)


def run_document(path: pathlib.Path, name: str, folder: pathlib.Path, tools: Tools,
                 fixtures: Fixtures) -> DocumentReport:
    report = DocumentReport(name)
    try:
        blocks = blocks_of(path, name)
    except DocumentError as error:
        report.failures.append(str(error))
        return report
    box = Sandbox(folder, tools.engram, tools.python_path)
    runner = _Runner(box, tools, fixtures)
    for block in blocks:
        try:
            runner.run(block, report)
        except (BlockError, DocumentError) as error:
            report.failures.append(f"{block.place}: {block.language or 'a block'}: {error}")
    report.failures += runner.close()
    return report


class _Runner:
    def __init__(self, box: Sandbox, tools: Tools, fixtures: Fixtures) -> None:
        self._box, self._tools, self._fixtures = box, tools, fixtures
        self._python: PythonSession | None = None
        self._printed = ""

    def run(self, block: Block, report: DocumentReport) -> None:
        if block.language not in LANGUAGES:
            raise BlockError(f"language '{block.language}'; needs one of {', '.join(LANGUAGES)}")
        orders = block.orders
        if orders.reason_not_to_run:
            report.left_out.append(f"{block.place}: {block.language}: {orders.reason_not_to_run}")
            return
        if block.language == "python" and not self._tools.python_path:
            report.left_out.append(f"{block.place}: python: this build has no Python module")
            return
        for fixture, target in orders.setups:
            self._box.copy_in(self._fixtures.path(fixture), target)
        report.counts[self._carry_out(block, _replaced(block))] += 1

    def close(self) -> list[str]:
        if self._python:
            self._python.close()
        return self._box.close()

    def _carry_out(self, block: Block, text: str) -> str:
        """Says what became of the block: run, compiled, checked, compared, text."""
        orders = block.orders
        if orders.file:
            target = self._box.folder / orders.file
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text)
        if block.language == "sh":
            self._shell(block, text)
            return "run"
        if block.language == "python":
            self._printed = self._interpreter().run(
                block.document, block.line - len(orders.before),
                _around(orders.before, text, orders.after))
            return "run"
        if block.language == "text":
            return self._text(block, text)
        if block.language == "cpp":
            self._cpp(block, text)
            return "compiled"
        return self._data(block, text)

    def _shell(self, block: Block, text: str) -> None:
        orders = block.orders
        commands = _around(orders.before, text, orders.after)
        if orders.ready is None:
            self._printed = self._box.run(commands, orders.exit_code)
        else:
            self._printed = self._box.start(commands, orders.ready, block.place)

    def _interpreter(self) -> PythonSession:
        if not self._python:
            self._python = PythonSession(self._box.folder, self._box.environment)
        return self._python

    def _text(self, block: Block, text: str) -> str:
        orders = block.orders
        if orders.before or orders.after:
            self._printed = self._box.run("\n".join(orders.before + orders.after),
                                          orders.exit_code)
            if not orders.is_shown:
                return "read by the program"
        if not orders.is_shown:
            if _COMMAND.match(text):
                raise BlockError("begins like a command; needs the language sh")
            return "text"
        missing = lines_not_in(text, self._printed)
        if missing:
            raise BlockError(f"was not printed by the block above: {missing[0]}\n"
                             f"which printed:\n{self._printed[:4000]}")
        return "compared"

    def _cpp(self, block: Block, text: str) -> None:
        orders = block.orders
        check_cpp(_around(orders.before, text, orders.after), self._box.folder,
                  block.line - len(orders.before), block.document,
                  flags_of(self._tools.compile_commands))

    def _data(self, block: Block, text: str) -> str:
        orders = block.orders
        if block.language == "cmake":
            check_cmake(_around(orders.before, text, orders.after), self._box.folder,
                        self._tools.source)
            return "run"
        if not orders.before and not orders.after:
            check_data(block.language, text)
            return "parsed"
        self._printed = self._box.run("\n".join(orders.before + orders.after), orders.exit_code)
        return "read by the program"


def _replaced(block: Block) -> str:
    text = block.text
    for old, new in block.orders.replaced:
        if old not in text:
            raise DocumentError(f"replaces '{old}', which is not there")
        text = text.replace(old, new)
    return text


def _around(before: list[str], text: str, after: list[str]) -> str:
    return "".join(line + "\n" for line in before) + text + "".join(line + "\n" for line in after)


def lines_not_in(shown: str, printed: str) -> list[str]:
    """Lines of a shown text that were not printed, whatever their figures, bytes and widths are.

    A line that ends in "..." stands for all that begin like it; one of "..." alone for any.
    """
    there = [_plain(line) for line in printed.split("\n")]
    missing = []
    for line in shown.split("\n"):
        plain = _plain(line)
        if plain.startswith("$ ") or not plain.strip(". "):
            continue
        if plain.endswith("..."):
            found = any(one.startswith(plain.rstrip(". ")) for one in there)
        else:
            found = plain in there
        if not found:
            missing.append(line)
    return missing


def _plain(line: str) -> str:
    return " ".join(_FIGURE.sub("0", line.rstrip(". ") + ("..." if line.endswith("...") else ""))
                    .split())
