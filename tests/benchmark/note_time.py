#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a compiler or linker and appends what it used to a file, one line of JSON per run.

    note_time.py NOTES BUILD SOURCE COMMAND...

BUILD and SOURCE are the folders that names are made relative to. It runs hundreds of times in a
build, so it imports little.
"""

from __future__ import annotations

import json
import os
import sys
import time


def run(command: list[str], output: int = 1) -> tuple[int, dict[str, float]]:
    """Runs a command; its exit code, and what it and all that it started used. Unit: seconds."""
    start = time.monotonic()
    process = os.posix_spawnp(command[0], command, os.environ,
                              file_actions=[(os.POSIX_SPAWN_DUP2, output, 1)])
    _, status, used = os.wait4(process, 0)
    return os.waitstatus_to_exitcode(status), {
        "user_s": used.ru_utime, "system_s": used.ru_stime, "wall_s": time.monotonic() - start}


def note_of(command: list[str], build: str, source: str, used: dict[str, float]) -> dict:
    """What a command made, of what; a link has no source."""
    def after(option: str) -> str:
        return command[command.index(option) + 1] if option in command[:-1] else ""

    compiled = after("-c")
    for root in (build, source):
        if compiled.startswith(root + "/"):
            compiled = compiled[len(root) + 1:]
            break
    return {"output": after("-o"), "source": compiled, **used}


def main() -> int:
    notes, build, source, *command = sys.argv[1:]
    code, used = run(command)
    line = json.dumps(note_of(command, build, source, used)) + "\n"
    file = os.open(notes, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
    os.write(file, line.encode())
    os.close(file)
    return code if code >= 0 else 128 - code


if __name__ == "__main__":
    sys.exit(main())
