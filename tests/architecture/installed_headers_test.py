#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Each header of ours that experiments include is installed. They are built against an installed
Engram, with minutes of compiling, so that few tests build them all."""

from __future__ import annotations

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
INCLUDE = re.compile(r'^#include "([\w/]+/[\w.]+\.h)"', re.MULTILINE)


def is_installed(header: str) -> bool:
    """A room lists what it installs as HEADERS (engram_add_library in cmake/EngramLibrary.cmake)."""
    room = (ROOT / header).parent
    lists = [room / "CMakeLists.txt", room.parent / "CMakeLists.txt"]
    listed = "".join(one.read_text(encoding="utf-8") for one in lists if one.exists())
    parts = re.findall(r"\bHEADERS\b([^)]*)", listed)
    return any(re.search(rf"(?<![\w.]){re.escape(pathlib.Path(header).name)}\b", part)
               for part in parts)


def main() -> int:
    missing, count = [], 0
    for source in sorted((ROOT / "experiments").rglob("*.[ch]*")):
        if source.suffix not in (".cpp", ".h"):
            continue
        for header in INCLUDE.findall(source.read_text(encoding="utf-8")):
            if not (ROOT / header).exists():
                continue  # Of the experiments themselves.
            count += 1
            if not is_installed(header):
                missing.append(f"{source.relative_to(ROOT)}: {header} is not installed")
    print(*missing, sep="\n")
    if count < 50:
        sys.exit(f"installed headers: found {count} includes, expected 50 at least")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
