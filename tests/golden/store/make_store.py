#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Makes a golden store: make_store.py FOLDER, once per version of the format, with its program.

What tests compare it with is made here too: the same formulas, without the store.
"""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np

CAMERA = "Vision/RGB/head/cam"
JOINTS = "RobotState/Proprioception/robot/joints"
SPEECH = "Speech/Commands/human/text"
COUNT = 24  # Sealed in segments; images and joints as latents, too.
UNSEALED = 4  # More, in a journal that nobody closed.
START = 1_600_000_000 * 10**9
STEP = 200_000_000


def time_at(i: int) -> int:
    return START + i * STEP


def image_at(i: int) -> np.ndarray:
    image = np.full((16, 24, 3), 50, np.uint8)
    image[:, :, 1] = 4 * np.arange(24)
    image[4:10, i % 16 : i % 16 + 8] = (220, 60, 30)
    return image


def joints_at(i: int) -> dict[str, Any]:
    return {
        "position": np.cos(0.2 * i + np.arange(3)),
        "torque": np.float32(0.5 * i),
        "steps": np.int32(i * i),
        "is_moving": i % 3 != 0,
        "image": f"{CAMERA}/{np.datetime64(time_at(i), 'us')}",
    }


def main(path: Path) -> None:
    import engram

    config = path.with_suffix(".yaml")
    config.write_text(
        "entities:\n  - match: .*\n    codecs:\n      - {kind: image, codec: rowpred}\n"
        "      - {kind: number, codec: columns}\n"
    )
    with engram.record(path, config=config) as recorder:
        for i in range(COUNT):
            record(recorder, i)
        recorder.commit(SPEECH, {"speaker": "Ada", "text": "Größe?"}, time_at(5))
    engram.consolidate(path, [CAMERA, JOINTS], steps=30, psnr=24, representation="latents",
                       width=16, threads=1, min_snapshots=2)
    recorder = engram.record(path, config=config)
    for i in range(COUNT, COUNT + UNSEALED):
        record(recorder, i)
    unsealed = path.with_suffix(".copy")
    shutil.copytree(path, unsealed)
    recorder.close()
    shutil.rmtree(path)
    os.rename(unsealed, path)
    for lock in path.glob("*.lock"):
        lock.unlink()
    config.unlink()


def record(recorder: Any, i: int) -> None:
    recorder.commit(CAMERA, {"image": image_at(i)}, time_at(i))
    recorder.commit(JOINTS, joints_at(i), time_at(i))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
