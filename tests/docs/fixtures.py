# SPDX-License-Identifier: Apache-2.0
"""Memories and recordings that documents begin with, each made once and copied."""

from __future__ import annotations

import pathlib
import threading
from dataclasses import dataclass, field

from markdown_blocks import DocumentError
from sandbox import BlockError, Sandbox

_SCENE = "engram simulate scene --seconds 12 --width 64 --height 48"
_IMPORT = ("engram import --video scene.mp4 --table scene.csv --entity Vision/RGB/head/cam "
           "--state-entity RobotState/Proprioception/robot/joints --rate 5 "
           "--start '2022-02-18 13:06:50.492182' robot.engram")

#: Name: the fixtures that it is made of, and how.
RECIPES: dict[str, tuple[list[str], str]] = {
    "scene.mp4": ([], f"{_SCENE} --video scene.mp4 --table scene.csv"),
    "scene.csv": ([], f"{_SCENE} --video scene.mp4 --table scene.csv"),
    "robot.engram": (["scene.mp4", "scene.csv"], _IMPORT),
    "learned.engram": (["robot.engram"], "mv robot.engram learned.engram && "
                       "engram consolidate learned.engram --steps 20 --psnr 30 --video h264"),
    "demo.engram": ([], "engram simulate kitchen demo.engram --fast --seconds 2 && engram "
                    "consolidate demo.engram --entity Vision/RGB/head/stereo --steps 2 --psnr 26 "
                    "--video h264"),
    "kitchen.engram": ([], "engram simulate kitchen kitchen.engram --fast --seconds 20 --seed 1"),
    "recording.mcap": (["robot.engram"],
                       "engram export robot.engram '@ all' --to mcap -o recording.mcap"),
    "demos.hdf5": (["robot.engram"],
                   "engram export robot.engram '@ all' --to robomimic -o demos.hdf5 && "
                   "/usr/bin/python3 -c \"import h5py; "
                   "data = h5py.File('demos.hdf5', 'r+')['data']; "
                   "data.copy('demo_0', 'demo_1')\""),
}


@dataclass
class Fixtures:
    """Makes what is asked for below `folder`. Threading: thread-safe."""

    folder: pathlib.Path
    engram: pathlib.Path
    source: pathlib.Path
    _made: dict[str, pathlib.Path | BlockError] = field(default_factory=dict)
    _locks: dict[str, threading.Lock] = field(default_factory=dict)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def path(self, name: str) -> pathlib.Path:
        """Where it is. A name that begins with `source/` is a file or folder of the sources."""
        if name.startswith("source/"):
            return self.source / name.removeprefix("source/")
        if name not in RECIPES:
            raise DocumentError(f"no fixture '{name}'; there are {', '.join(RECIPES)}")
        with self._lock:
            lock = self._locks.setdefault(name, threading.Lock())
        with lock:
            if name not in self._made:
                try:
                    self._made[name] = self._make(name)
                except BlockError as error:
                    self._made[name] = error
            made = self._made[name]
        if isinstance(made, BlockError):
            raise DocumentError(f"fixture '{name}': {made}")
        return made

    def _make(self, name: str) -> pathlib.Path:
        needed, commands = RECIPES[name]
        box = Sandbox(self.folder / name, self.engram, "")
        for one in needed:
            box.copy_in(self.path(one), one)
        box.run(commands)
        if not (made := self.folder / name / name).exists():
            raise BlockError(f"was not made by: {commands}")
        return made
