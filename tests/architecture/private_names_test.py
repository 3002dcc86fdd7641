#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Names in anonymous namespaces are met once in a room, because its sources are compiled together
(ENGRAM_UNITY in CMakeLists.txt): which of them share a unit changes with each source that is added.

    private_names_test.py
"""

from __future__ import annotations

import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOMS = ("augmentation", "cli", "datasets", "encoders", "ltm", "memory", "python", "reports",
         "server", "speech", "tests/benchmark", "training", "viewer")
# Sources of programs of their own.
PROGRAMS = ("idf_main.cpp", "launcher.cpp")
START = re.compile(r"^namespace \{$", re.MULTILINE)
END = re.compile(r"^\}  // namespace$", re.MULTILINE)
CONSTANT = re.compile(r"^(?:inline |static |thread_local )*const(?:expr|init)? [^=;({]*?"
                      r"\b(k[A-Z]\w*)\s*(?:\[|=|\{|;)", re.MULTILINE)
TYPE = re.compile(r"^(?:class|struct|enum class|enum) (?:\[\[\w+\]\] )?(\w+)[^;(]*?\{", re.MULTILINE)
ALIAS = re.compile(r"^using (\w+) =", re.MULTILINE)
FUNCTION = re.compile(r"^(?! |using |return |template|constexpr k|struct |class |enum )"
                      r"[\w:<>,&*\[\] ]+[ &*](\w+)\(([^;{]*?)\)[^;{()]*\{", re.MULTILINE)


def private_parts(text: str) -> list[str]:
    parts = []
    for start in START.finditer(text):
        end = END.search(text, start.end())
        parts.append(text[start.end():end.start() if end else len(text)])
    return parts


def names_of(part: str) -> set[str]:
    found = {name for pattern in (CONSTANT, TYPE, ALIAS) for name in pattern.findall(part)}
    # Functions of one name may differ in what they take.
    for name, parameters in FUNCTION.findall(part):
        types = re.sub(r"\s+", " ", re.sub(r"\b\w+(?=\s*(,|$|=))", "", parameters)).strip()
        found.add(f"{name}({types})")
    return found


def namespace_of(text: str) -> str:
    match = re.search(r"^namespace ([\w:]+) \{$", text, re.MULTILINE)
    return match.group(1) if match else ""


def main() -> int:
    count = 0
    clashes = []
    for room in sorted({path.parent for name in ROOMS for path in (ROOT / name).rglob("*.cpp")}):
        met: dict[tuple[str, str], list[str]] = collections.defaultdict(list)
        for source in sorted(room.glob("*.cpp")):
            if source.name in PROGRAMS:
                continue
            text = source.read_text(encoding="utf-8")
            for name in set().union(*map(names_of, private_parts(text)), set()):
                met[namespace_of(text), name].append(source.name)
        count += len(met)
        clashes += [f"{room.relative_to(ROOT)}: {name} is in {' and in '.join(sources)}"
                    for (_, name), sources in sorted(met.items()) if len(sources) > 1]
    print(*clashes, sep="\n")
    if count < 1000:
        sys.exit(f"private names: found {count}, expected 1,000 at least")
    print(f"{count} private names, {len(clashes)} of them in two sources of a room")
    return 1 if clashes else 0


if __name__ == "__main__":
    sys.exit(main())
