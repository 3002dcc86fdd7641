#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Writes docs/reference/cli.md, what `engram COMMAND --help` says of every command.

generate_command_reference.py ENGRAM [--check]
"""

from __future__ import annotations

import difflib
import pathlib
import subprocess
import sys

REFERENCE = pathlib.Path(__file__).resolve().parent / "reference" / "cli.md"

_INTRODUCTION = """\
# Command line

What `engram COMMAND --help` says, of every command. `make reference` writes this page; a test
compares it with the program.

"""


def help_of(engram: str, command: tuple[str, ...]) -> str:
    return subprocess.run([engram, *command, "--help"], check=True, capture_output=True,
                          text=True).stdout.strip("\n")


def subcommands_of(text: str) -> list[str]:
    """Names below "Subcommands:" in a help text."""
    lines = iter(text.split("\n"))
    if "Subcommands:" not in lines:  # Goes on behind that line.
        return []
    names = []
    for line in lines:
        if not line.startswith("  "):
            break
        if not line.startswith("   "):
            names.append(line.split()[0])
    return names


def commands_of(engram: str, command: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], str]]:
    """All commands with their help, each before those that it has in turn."""
    text = help_of(engram, command)
    found = [(command, text)]
    for name in subcommands_of(text):
        found += commands_of(engram, (*command, name))
    return found


def reference_of(commands: list[tuple[tuple[str, ...], str]]) -> str:
    titles = [" ".join(("engram", *command)) for command, _ in commands]
    index = [f"* [`{title}`](#{title.replace(' ', '-')})" for title in titles]
    pages = [f"## {title}\n\n```text\n{_plain(text)}\n```\n"
             for title, (_, text) in zip(titles, commands, strict=True)]
    return _INTRODUCTION + "\n".join(index) + "\n\n" + "\n".join(pages)


def _plain(text: str) -> str:
    return "\n".join(line.rstrip() for line in text.split("\n"))


def main() -> int:
    text = reference_of(commands_of(sys.argv[1]))
    if "--check" not in sys.argv[2:]:
        REFERENCE.parent.mkdir(exist_ok=True)
        REFERENCE.write_text(text)
        return 0
    old = REFERENCE.read_text() if REFERENCE.exists() else ""
    sys.stdout.writelines(difflib.unified_diff(old.splitlines(True), text.splitlines(True),
                                               "docs/reference/cli.md", "the program"))
    return 0 if text == old else 1


if __name__ == "__main__":
    sys.exit(main())
