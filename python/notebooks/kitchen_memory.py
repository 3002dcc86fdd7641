# SPDX-License-Identifier: Apache-2.0
"""The memory that the notebooks look at: a simulated kitchen, recorded and consolidated once.

ENGRAM_SECONDS and ENGRAM_BUDGET, in the environment, make it shorter or better; the program
`engram` has to be on the PATH.
"""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np

import engram

CAMERA = "Vision/RGB/head/stereo"
JOINTS = "RobotState/Proprioception/robot/joints"
SECONDS = float(os.environ.get("ENGRAM_SECONDS", 60))
BUDGET = float(os.environ.get("ENGRAM_BUDGET", 240))
#: Five stereo images and twenty joint states a second.
CONFIG = """
entities:
  - match: Vision/RGB/.*
    filters: [{frequency: {rate: 5Hz}}]
  - match: RobotState/.*
    filters: [{frequency: {rate: 20Hz}}]
"""


def record_kitchen(path: Path = Path("kitchen.engram")) -> Path:
    """A humanoid that is asked to bring things; recorded where it is not there yet."""
    if not path.exists():
        config = path.with_suffix(".yaml")
        config.write_text(CONFIG)
        run("simulate", "kitchen", path, "--fast", "--seconds", SECONDS, "--seed", 3,
            "--config", config)
    return path


def learn_kitchen(path: Path = Path("learned.engram")) -> Path:
    """The same with latents; trained where it is not there yet."""
    if not path.exists():
        unfinished = path.with_suffix(".unfinished")
        shutil.rmtree(unfinished, ignore_errors=True)
        shutil.copytree(record_kitchen(), unfinished)
        engram.consolidate(unfinished, [CAMERA, JOINTS], training=BUDGET, psnr=35,
                           representation="latents")
        unfinished.rename(path)
    return path


def run(*words: object) -> str:
    """What the program `engram` prints."""
    return subprocess.run(["engram", *map(str, words)], check=True, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout


def actions(memory: engram.Memory) -> list[tuple[str, int, int]]:
    """Name, start and end in ns of everything that the robot did."""
    found = []
    for entity in memory:
        if entity.name.startswith("Skill/Event/"):
            for snapshot in entity:
                value = snapshot.value
                if value["ended"] is not None:
                    skill = value["skill"].rpartition("/")[2]
                    found.append((skill, int(value["started"]), int(value["ended"])))
    return sorted(found, key=lambda action: action[1])


def actions_at(memory: engram.Memory, times: np.ndarray) -> np.ndarray:
    """The name of what was done at each moment; "none"."""
    names = np.full(len(times), "none", dtype="<U10")
    for name, start, end in actions(memory):
        names[(times >= np.datetime64(start, "ns")) & (times < np.datetime64(end, "ns"))] = name
    return names


def psnr_db(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Of each image (N, H, W, C) on 8 bits."""
    mse = np.square(a.astype(float) - b).mean(axis=(1, 2, 3))
    return 10 * np.log10(255**2 / np.maximum(mse, 1e-9))
