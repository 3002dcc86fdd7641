#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks with clang that what a mutex guards is used with that mutex held, and in which order they
are taken. Reads the flags of each source from the build folder; compiles nothing.

Usage: check_locks.py [--build build/dev] [--jobs N] [FOLDER or FILE ...]
"""

import argparse
import concurrent.futures
import json
import os
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Where locks are checked: all that is installed. Tests and experiments lock as they like.
ROOMS = ("augmentation", "cli", "datasets", "encoders", "ltm", "memory", "python", "reports",
         "server", "speech", "training", "viewer")
#: What has the capabilities; a source that does not see it has no lock to check.
MUTEX = "ltm/core/mutex.h"
COMPILER = "clang++-14"
CHECKS = ("-fsyntax-only", "-Wno-everything", "-Wthread-safety", "-Wthread-safety-beta",
          "-Werror=thread-safety", "-Werror=thread-safety-beta")
_INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def includes(path: Path, root: Path, known: dict[Path, list[Path]]) -> list[Path]:
    """Files of the project that a file includes."""
    if path not in known:
        names = _INCLUDE.findall(path.read_text(encoding="utf-8", errors="replace"))
        known[path] = [root / name for name in names if (root / name).is_file()]
    return known[path]


def sees_mutex(path: Path, root: Path, known: dict[Path, list[Path]]) -> bool:
    """Whether a source includes the mutexes, directly or through others."""
    seen, waiting = {path}, [path]
    while waiting:
        for included in includes(waiting.pop(), root, known):
            if included == root / MUTEX:
                return True
            if included not in seen:
                seen.add(included)
                waiting.append(included)
    return False


def arguments_for(command: str) -> list[str]:
    """GCC's command as one of clang that only checks: without output, and without GCC's
    precompiled headers, which clang cannot read."""
    given = shlex.split(command)[1:]
    kept: list[str] = []
    while given:
        word = given.pop(0)
        if word == "-o" or (word == "-include" and given[0].endswith("cmake_pch.hxx")):
            given.pop(0)
        elif word not in ("-c", "-Winvalid-pch", "-Werror"):
            kept.append(word)
    return [COMPILER, *kept, *CHECKS]


def compiled_sources(build: Path, root: Path) -> list[tuple[Path, str, str]]:
    """Sources of the project, each with the folder and the command that compile it. Sources that are
    compiled together have the command of all of them, with their own name."""
    found = []
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        file = Path(entry["file"])
        if file.parent.name != "Unity":
            found.append((file, entry["directory"], entry["command"]))
            continue
        for name in _INCLUDE.findall(file.read_text(encoding="utf-8")):
            command = entry["command"].replace(f" -c {file}", f" -c {name}")
            found.append((Path(name), entry["directory"], command))
    return [one for one in found if one[0].is_relative_to(root)]


def sources_of(build: Path, root: Path, wanted: list[Path]) -> dict[Path, tuple[str, list[str]]]:
    """Sources that have locks to check: where each is compiled, and how it is checked."""
    known: dict[Path, list[Path]] = {}
    found: dict[Path, tuple[str, list[str]]] = {}
    for path, directory, command in compiled_sources(build, root):
        if path in found:
            continue
        if path.relative_to(root).parts[0] not in ROOMS:
            continue
        if wanted and not any(path.is_relative_to(one) for one in wanted):
            continue
        if sees_mutex(path, root, known):
            found[path] = (directory, arguments_for(command))
    return found


def check(job: tuple[str, list[str]]) -> tuple[bool, str]:
    directory, arguments = job
    done = subprocess.run(arguments, cwd=directory, capture_output=True, text=True, check=False)
    return done.returncode == 0, done.stderr


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=ROOT / "build/dev")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("paths", type=Path, nargs="*")
    given = parser.parse_args()
    sources = sources_of(given.build, ROOT, [path.resolve() for path in given.paths])
    if not sources:
        print("check-locks: found no source with a lock, needs one", file=sys.stderr)
        return 1
    began = time.monotonic()
    failed: list[Path] = []
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        for path, (is_good, said) in zip(sources, pool.map(check, sources.values())):
            if is_good:
                continue
            failed.append(path)
            print(said, end="", flush=True)
    seconds = time.monotonic() - began
    print(f"check-locks: {len(sources)} sources in {seconds:.0f} s, {len(failed)} with errors")
    for path in failed:
        print(f"  {path.relative_to(ROOT)}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
