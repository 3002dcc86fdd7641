# SPDX-License-Identifier: Apache-2.0
"""A live memory of this process and one of a server, for tests that are held against both."""

import pathlib
import tempfile

from served import Server

import engram

CUP = "Objects/Things/kitchen/cup"
START = 1_600_000_000 * 10**9
ENOUGH = 20  # Seconds; nothing should need so many.


class Door:
    """Mixed into tests: `self.memory` is committed to."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.open()
        self.addCleanup(self.memory.close)

    def commit(self, i, **value):
        self.memory.commit(CUP, value or {"x": 0.1 * i}, START + i * 200_000_000)


class OpenedDoor(Door):
    def open(self):
        self.path = self.folder / "robot.engram"
        self.memory = engram.open(self.path, read_only=False)


class ConnectedDoor(Door):
    program = ""  # That serves.

    def open(self):
        self.server = Server(self.program, self.folder, self.folder / "robot.engram")
        self.addCleanup(self.server.kill)
        self.memory = engram.connect(self.server.endpoint)
