# SPDX-License-Identifier: Apache-2.0
"""A deep episodic memory for robots.

    import engram

    with engram.open("robot.engram") as memory:
        camera = memory["Vision/RGB/head/cam"]
        for snapshot in camera.snapshots("2022-02-18T13:00", "2022-02-18T13:01"):
            print(snapshot.time, snapshot.image.mean())
        print(camera.ahead(0.4).source)  # predicted

`engram.idf`, values and types, needs NumPy alone; all else the module that CMake builds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from engram.memory import Entity, Memory, open  # noqa: A004
    from engram.snapshot import Instance, MeasuredError, Snapshot

_PLACES = {
    "Entity": "engram.memory",
    "Instance": "engram.snapshot",
    "MeasuredError": "engram.snapshot",
    "Memory": "engram.memory",
    "Snapshot": "engram.snapshot",
    "open": "engram.memory",
}

__all__ = ["Entity", "Instance", "MeasuredError", "Memory", "Snapshot", "open"]


def __getattr__(name: str) -> Any:
    """Loads the compiled module when it is asked for: `engram.idf` does without."""
    if name not in _PLACES:
        raise AttributeError(f"module 'engram' has no attribute '{name}'")
    import importlib

    return getattr(importlib.import_module(_PLACES[name]), name)
