# SPDX-License-Identifier: Apache-2.0
"""A recorded kitchen as lists that may be changed, and back into a store."""
import pathlib
import re
import subprocess
import sys
import tempfile

import engram
import numpy as np


JOINTS = "RobotState/Proprioception/robot/joints"
PLATFORM = "RobotState/Localization/robot/platform"
CAMERA = "Vision/RGB/head/stereo"
ROOT = pathlib.Path(__file__).resolve().parents[2]
TYPES = ROOT / "datasets/kitchen/kitchen_types.xml"
SKILL_TYPES = "ltm/skills/skill_types.xml"
MOMENT = re.compile(r"/(\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d+)/\d+$")
CLASSES = {
    "Objects/Classes": "ObjectClass", "Objects/Instances": "ObjectInstance",
    "Objects/Surfaces": "Surface", "RobotState/Description": "RobotDescription",
    "RobotState/Localization": "PlatformState", "RobotState/Proprioception": "JointState",
    "Simulation/Recording": "Recording", "Skill/Executable": "Executable",
    "Skill/ExecutionRequest": "ExecutionRequest", "Skill/Event": "Event",
    "Skill/Event/robot": "Action", "Speech/Commands": "Speech",
    "Tasks/Plans": "Plan", "Vision/Calibration": "CameraCalibration", "Vision/RGB": "View",
}


class Snap:
    """One snapshot: a time in ns and the values of its instances."""

    def __init__(self, time, values):
        self.time = time
        self.values = values

    def copy(self, time=None):
        return Snap(self.time if time is None else time, [copied(value) for value in self.values])


def copied(value):
    """Dicts and lists are copied, arrays too, so that a change stays where it was made."""
    if isinstance(value, dict):
        return {key: copied(part) for key, part in value.items()}
    if isinstance(value, list):
        return [copied(part) for part in value]
    return value.copy() if hasattr(value, "shape") and value.shape and value.size < 10000 else value


def shifted(value, by):
    """A value whose times and links to moments are later."""
    if isinstance(value, dict):
        return {key: part + by if key in ("started", "ended") and part is not None
                else shifted(part, by) for key, part in value.items()}
    if isinstance(value, list):
        return [shifted(part, by) for part in value]
    if isinstance(value, str) and (match := MOMENT.search(value)):
        time = np.datetime64(match[1].replace(" ", "T"), "ns") + np.timedelta64(by, "ns")
        return value[:match.start(1)] + str(time).replace("T", " ") + value[match.end(1):]
    return value


def write_one_after_the_other(stores, count, store):
    """Recordings of a minute as one that is as many minutes long."""
    begin = None
    for i in range(count):
        kitchen = Kitchen(stores[i % len(stores)])
        begin = kitchen.first if begin is None else begin + 60 * 10**9
        kitchen.shift(begin)
        kitchen.write(store)


class Kitchen:
    """All snapshots of a store, by entity."""

    def __init__(self, store):
        with engram.open(store) as memory:
            answer = memory.query(".*/.*/.*/.* @ all")
        self.entities = {
            str(entity): [Snap(one.time, [copied(part.value) for part in one.instances])
                          for one in snapshots]
            for entity, snapshots in answer.items()
        }
        everything = [snap.time for snaps in self.entities.values() for snap in snaps]
        self.first, self.last = min(everything), max(everything)

    def objects(self):
        return [name for name in self.entities if name.startswith("Objects/Instances/")]

    def actions(self):
        return [name for name in self.entities if name.startswith("Skill/Event/")]

    def between(self, entity, first, last):
        """Indices of the snapshots of a span."""
        snaps = self.entities[entity]
        return [i for i, snap in enumerate(snaps) if first <= snap.time <= last]

    def shift(self, begin):
        """Lets it begin at another time; links and times in values follow."""
        by = begin - self.first
        for snaps in self.entities.values():
            for snap in snaps:
                snap.time += by
                snap.values = [shifted(value, by) for value in snap.values]
        self.first, self.last = self.first + by, self.last + by

    def write(self, store):
        """Into a new store, or behind what is there, with the types of the kitchen."""
        types = kitchen_types()
        with engram.open(store, read_only=False) as memory:
            for segment, name in CLASSES.items():
                memory.declare(segment, getattr(types, name))
        updates = [
            (snap.time, entity, snap) for entity, snaps in self.entities.items() for snap in snaps
        ]
        updates.sort(key=lambda update: update[0])
        with engram.record(store) as recorder:
            for begin in range(0, len(updates), 400):
                recorder._store.commit([  # noqa: SLF001: commit_all() takes one instance each.
                    {"entity": entity, "time": time,
                     "instances": [{"value": value, "created": time, "sent": time, "provider": "",
                                    "confidence": 1.0} for value in snap.values]}
                    for time, entity, snap in updates[begin:begin + 400]])


def kitchen_types(made=[]):  # noqa: B006: made once.
    """The classes that `engram idf generate` makes of the types of the kitchen."""
    if not made:
        folder = tempfile.mkdtemp()
        for types, where in ((TYPES, folder), (ROOT / SKILL_TYPES, f"{folder}/ltm/skills")):
            subprocess.run([kitchen_types.engram, "idf", "generate", types, "-I", ROOT,
                            "--python", where], check=True, stdout=subprocess.DEVNULL)
        sys.path.insert(0, folder)
        made.append(__import__("kitchen_types"))
    return made[0]
