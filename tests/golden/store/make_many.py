#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Makes a golden store of many entities: make_many.py FOLDER, with PYTHONPATH of that program.

They share groups in its segments, and the manifest packs what it says of them (format version 2).
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

COUNT, ROUNDS = 1100, 2
START, SECOND = 1_600_000_000 * 10**9, 10**9


def entity_at(i: int) -> str:
    return f"Objects/Things/room {i % 7}/thing {i:04}"


def time_at(i: int, round_number: int) -> int:
    return START + (round_number * COUNT + i) * SECOND


def value_at(i: int, round_number: int) -> Any:
    """Values of three layouts, and some that no others are like."""
    if i % 100 == 99:
        return {f"only of {i}": i, "round": round_number}
    if i % 3 == 0:
        return {"height": i * 0.25 + round_number, "name": f"thing {i}"}
    if i % 3 == 1:
        return {"position": np.arange(3, dtype=np.float64) * i, "is_held": i % 2 == 0}
    return i * 1000 + round_number


def main(path: Path) -> None:
    import engram

    for round_number in range(ROUNDS):
        with engram.record(path) as recorder:
            for i in range(COUNT):
                recorder.commit(entity_at(i), value_at(i, round_number), time_at(i, round_number))
    for leftover in [*path.rglob("*.lock"), *path.glob("tmp/*")]:
        leftover.unlink()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
