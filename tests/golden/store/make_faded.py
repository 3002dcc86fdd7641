#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Makes a golden store of videos: make_faded.py ENGRAM FOLDER, with PYTHONPATH of that program.

Its videos begin from a picture that the model holds. The oldest recordings have become gists, those
after them have faded, and the rest is as good as it was consolidated.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np

CAMERA = "Vision/RGB/head/cam"
ROWS = 16  # Images of a recording.
GISTS, FADED, ALL = 1, 5, 14  # Recordings up to which.
PSNR_DB, FADED_DB = 40, 26
HOUR, SECOND = 3600 * 10**9, 10**9
START = 1_600_000_000 * 10**9
SIDE = 64


def time_at(i: int) -> int:
    return START + i // ROWS * HOUR + i % ROWS * SECOND


def image_at(i: int) -> np.ndarray:
    """A textured room with a mark that moves."""
    y, x, c = np.mgrid[0:SIDE, 0:SIDE, 0:3]
    image = 50 + (x * x + 3 * y * x + 7 * y) % 61 + 5 * c
    image[(x // 8 == i % 8) & (y // 8 == i // 8 % 8)] = 240
    return image.astype(np.uint8)


def main(program: str, path: Path) -> None:
    import engram

    with engram.record(path) as recorder:
        for i in range(ALL * ROWS):
            recorder.commit(CAMERA, {"image": image_at(i), "number": np.float64(i)}, time_at(i))
    subprocess.run(
        [program, "consolidate", path, "--representation", "video", "--psnr", str(PSNR_DB),
         "--training", "3s", "--drop-raw", "--grace", "0s"], check=True
    )
    fade(program, path, FADED, f"psnr: {FADED_DB}")
    fade(program, path, GISTS, "form: gist")
    for leftover in [*path.rglob("*.lock"), *path.glob("tmp/*")]:
        leftover.unlink()


def fade(program: str, path: Path, recordings: int, step: str) -> None:
    """Lets the first so many recordings fade."""
    config = path.with_suffix(".yaml")
    end = np.datetime64(time_at(recordings * ROWS), "ns") - np.timedelta64(60 * SECOND, "ns")
    age = (np.datetime64("now", "ns") - end) // np.timedelta64(SECOND, "ns")
    config.write_text(
        "forget:\n  protect: {newest: 0}\n"
        f"  fade:\n    - {{match: Vision, after: {age}s, {step}}}\n"
    )
    subprocess.run([program, "forget", path, "--config", config, "--yes"], check=True)
    config.unlink()


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
