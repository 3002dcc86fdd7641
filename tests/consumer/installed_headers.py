#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The headers of an installation are the public roots and what these include, and compile alone.

Usage: installed_headers.py PREFIX CONSUMER_BUILD

The roots are those of cmake/EngramPublicHeaders.cmake; what they include is followed here once more,
in the installed files. A header is compiled with the options of the consumer, which see the
installation and the libraries of others, but not these sources.
"""

from __future__ import annotations

import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
_INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
_HAS_SERVER = re.compile(r"^set\(ENGRAM_SERVER (ON|TRUE|1)\)", re.MULTILINE | re.IGNORECASE)


def public_roots(has_server: bool) -> list[str]:
    text = (SOURCE / "cmake" / "EngramPublicHeaders.cmake").read_text()
    listed = re.search(r"set\(ENGRAM_PUBLIC_ROOTS(.*?)\)\n", re.sub(r"#.*", "", text), re.DOTALL)
    assert listed, "cmake/EngramPublicHeaders.cmake has no ENGRAM_PUBLIC_ROOTS"
    return [root for root in listed[1].split() if has_server or not root.startswith("server/")]


def closure(roots: list[str], folder: pathlib.Path) -> set[str]:
    """What roots include, themselves among it; a missing header is in it, too."""
    found: set[str] = set()
    waiting = list(roots)
    while waiting:
        header = waiting.pop()
        if header not in found:
            found.add(header)
            file = folder / header
            waiting += _INCLUDE.findall(file.read_text()) if file.exists() else []
    return found


def named_by_generator() -> set[str]:
    """Headers that generated code may include."""
    named: set[str] = set()
    for file in (SOURCE / "ltm" / "idf").glob("generate_cpp*.cpp"):
        code = re.sub(r"^#include.*$", "", file.read_text(), flags=re.MULTILINE)
        named |= set(re.findall(r'"(ltm/\w+/\w+\.h)"', code))
    return named


def consumer_options(build: pathlib.Path) -> list[str]:
    """How the consumer compiles main.cpp: language, folders and definitions."""
    commands = json.loads((build / "compile_commands.json").read_text())
    words = next(shlex.split(one["command"]) for one in commands
                 if one["file"].endswith("/main.cpp"))
    options = []
    for word, following in zip(words, words[1:] + [""]):
        if word.startswith(("-std=", "-D", "-I")):
            options.append(word)
        if word == "-isystem":
            options += [word, following]
    seen = [word for word in options if str(SOURCE) in word and str(build) not in word]
    assert not seen, f"a consumer sees the sources of Engram: {seen}"
    return options


def problem_of(header: str, folder: pathlib.Path, options: list[str]) -> str:
    done = subprocess.run(["c++", *options, "-I", folder, "-fsyntax-only", "-x", "c++", "-"],
                          input=f'#include "{header}"\n', capture_output=True, text=True,
                          check=False, cwd="/")
    return f"{header} does not compile alone:\n{done.stderr}" if done.returncode else ""


def problems_of(prefix: pathlib.Path, build: pathlib.Path) -> tuple[set[str], list[str]]:
    """The installed headers, and what is wrong with them."""
    folder = prefix / "include" / "engram"
    config = next(prefix.glob("lib*/**/engramConfig.cmake")).read_text()
    installed = {str(file.relative_to(folder)) for file in folder.rglob("*") if file.is_file()}
    promised = closure(public_roots(bool(_HAS_SERVER.search(config))), folder)
    problems = [f"{header} is promised, but not installed" for header in promised - installed]
    problems += [f"{header} is installed, but not promised" for header in installed - promised]
    problems += [f"generated code includes {header}, which is not installed"
                 for header in named_by_generator() - installed]
    options = consumer_options(build)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = pool.map(lambda header: problem_of(header, folder, options), sorted(installed))
        problems += [problem for problem in found if problem]
    return installed, sorted(problems)


def main() -> int:
    installed, problems = problems_of(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
    for problem in problems:
        print(problem, file=sys.stderr)
    print(f"{len(installed)} headers are installed")
    return 1 if problems or not installed else 0


if __name__ == "__main__":
    sys.exit(main())
