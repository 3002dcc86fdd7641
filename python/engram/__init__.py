# SPDX-License-Identifier: Apache-2.0
"""A deep episodic memory for robots.

    import engram

    with engram.record("robot.engram") as recorder:
        recorder.commit("Vision/RGB/head/cam", {"image": image})

    engram.consolidate("robot.engram", training=600, progress=True)

    with engram.open("robot.engram") as memory:
        camera = memory["Vision/RGB/head/cam"]
        for snapshot in camera.snapshots("2022-02-18T13:00", "2022-02-18T13:01"):
            print(snapshot.time, snapshot.image.mean())
        print(camera.ahead(0.4).source)  # predicted

    with engram.connect("unix:/run/engram.sock") as memory:  # A server; the same questions.
        memory.commit("Objects/Things/kitchen/cup", {"x": 0.4})
        for event in memory.watch("Objects"):
            print(event.entity, event.value)

`engram.idf`, values and types, needs NumPy alone; all else the module that CMake builds.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from engram.entity import Entity
    from engram.errors import EngramError
    from engram.jobs import check, consolidate, forget, notice, reflect
    from engram.likeness import MomentMap, Similar, SimilarMoment
    from engram.memory import Memory, connect, open  # noqa: A004
    from engram.model import Latents, Model, Prediction
    from engram.progress import Bar, Progress
    from engram.recording import Recorder, Update, record
    from engram.replaying import Replaying, ReplayState, replay
    from engram.saliency import Salient, SalientPart
    from engram.skills import (
        SkillEnd,
        SkillFailure,
        SkillProvider,
        SkillResult,
        SkillRun,
        provide,
        run_skill,
        skill,
    )
    from engram.snapshot import Engine, Instance, MeasuredError, MemberPrediction, Snapshot
    from engram.speech import Answer, Evidence, Told
    from engram.viewing import View
    from engram.watching import Event, Watch

_PLACES = {
    "Answer": "engram.speech",
    "Bar": "engram.progress",
    "EngramError": "engram.errors",
    "Engine": "engram.snapshot",
    "Entity": "engram.entity",
    "Event": "engram.watching",
    "Evidence": "engram.speech",
    "Instance": "engram.snapshot",
    "Latents": "engram.model",
    "MeasuredError": "engram.snapshot",
    "MemberPrediction": "engram.snapshot",
    "Memory": "engram.memory",
    "Model": "engram.model",
    "MomentMap": "engram.likeness",
    "Prediction": "engram.model",
    "Progress": "engram.progress",
    "Recorder": "engram.recording",
    "ReplayState": "engram.replaying",
    "Replaying": "engram.replaying",
    "Salient": "engram.saliency",
    "SalientPart": "engram.saliency",
    "Similar": "engram.likeness",
    "SimilarMoment": "engram.likeness",
    "SkillEnd": "engram.skills",
    "SkillFailure": "engram.skills",
    "SkillProvider": "engram.skills",
    "SkillResult": "engram.skills",
    "SkillRun": "engram.skills",
    "Snapshot": "engram.snapshot",
    "Told": "engram.speech",
    "Update": "engram.recording",
    "View": "engram.viewing",
    "Watch": "engram.watching",
    "check": "engram.jobs",
    "connect": "engram.memory",
    "consolidate": "engram.jobs",
    "forget": "engram.jobs",
    "notice": "engram.jobs",
    "open": "engram.memory",
    "provide": "engram.skills",
    "record": "engram.recording",
    "reflect": "engram.jobs",
    "replay": "engram.replaying",
    "run_skill": "engram.skills",
    "skill": "engram.skills",
}

__all__ = [
    "Answer",
    "Bar",
    "EngramError",
    "Engine",
    "Entity",
    "Event",
    "Evidence",
    "Instance",
    "Latents",
    "MeasuredError",
    "MemberPrediction",
    "Memory",
    "Model",
    "MomentMap",
    "Prediction",
    "Progress",
    "Recorder",
    "ReplayState",
    "Replaying",
    "Salient",
    "SalientPart",
    "Similar",
    "SimilarMoment",
    "SkillEnd",
    "SkillFailure",
    "SkillProvider",
    "SkillResult",
    "SkillRun",
    "Snapshot",
    "Told",
    "Update",
    "View",
    "Watch",
    "check",
    "connect",
    "consolidate",
    "forget",
    "notice",
    "open",
    "provide",
    "record",
    "reflect",
    "replay",
    "run_skill",
    "skill",
]

# OpenMP reads it when it is loaded: its threads sleep where they wait, else they starve each other
# as soon as another process wants a core (docs/learning.md, section "Speed").
if "GOMP_SPINCOUNT" not in os.environ:
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")


def __getattr__(name: str) -> Any:
    """Loads the compiled module when it is asked for: `engram.idf` does without."""
    if name not in _PLACES:
        raise AttributeError(f"module 'engram' has no attribute '{name}'")
    import importlib

    return getattr(importlib.import_module(_PLACES[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
