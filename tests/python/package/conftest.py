# SPDX-License-Identifier: Apache-2.0
"""A memory that was recorded and consolidated from Python, for all tests of the package."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path

import hypothesis
import numpy as np
import pytest

import engram

hypothesis.settings.register_profile("engram", database=None)
hypothesis.settings.load_profile("engram")

CAMERA = "Vision/RGB/head/cam"
JOINTS = "RobotState/Proprioception/robot/joints"
SPEECH = "Speech/Commands/human/text"
START = 1_600_000_000 * 10**9
STEP = 200_000_000
COUNT = 48


def image_at(i: int) -> np.ndarray:
    """A bright square that moves over a shaded ground."""
    image = np.zeros((40, 48, 3), np.uint8)
    image[:, :, 0] = 40 + np.arange(48)
    image[:, :, 1] = 40 + 2 * np.arange(40)[:, None]
    left = 2 * i % 36
    image[14:26, left : left + 12] = (230, 60, 40)
    return image


def joints_at(i: int) -> dict[str, object]:
    angles = np.sin(np.arange(3) + 0.1 * i)
    return {"position": angles, "load": 0.5 + 0.1 * i, "is_moving": i % 2 == 0}


def time_at(i: int) -> int:
    return START + i * STEP


@dataclass(frozen=True)
class Recorded:
    path: Path
    images: np.ndarray
    times: list[int]


def record(path: Path) -> Recorded:
    with engram.record(path) as recorder:
        for i in range(COUNT):
            recorder.commit_all(
                [
                    engram.Update(CAMERA, {"image": image_at(i)}, time_at(i)),
                    engram.Update(JOINTS, joints_at(i), time_at(i)),
                ]
            )
        recorder.commit(SPEECH, {"text": "Bring me the salt", "speaker": "Ada"}, time_at(3))
    images = np.stack([image_at(i) for i in range(COUNT)])
    return Recorded(path, images, [time_at(i) for i in range(COUNT)])


@pytest.fixture(scope="session")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    return record(tmp_path_factory.mktemp("recorded") / "robot.engram")


@pytest.fixture(scope="session")
def learned(recorded: Recorded, tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    """The same, with latents of everything that can have some."""
    path = tmp_path_factory.mktemp("learned") / "robot.engram"
    shutil.copytree(recorded.path, path)
    engram.consolidate(
        path, steps=60, psnr=26, representation="latents", width=16, threads=1, min_snapshots=10
    )
    return Recorded(path, recorded.images, recorded.times)


@pytest.fixture
def copied(recorded: Recorded, tmp_path: Path) -> Path:
    """A store that a test may change."""
    shutil.copytree(recorded.path, tmp_path / "robot.engram")
    return tmp_path / "robot.engram"
