# SPDX-License-Identifier: Apache-2.0
"""One night of one store: a day is recorded, predicted, consolidated, and read again.

The program is told by options alone what kind of night it is. It knows the time only from the
machine's clock, which does not follow the days of the month: its --grace is two days and what lies
between the night and now.
"""
from __future__ import annotations

import json
import pathlib
import signal
import time
from dataclasses import dataclass
from typing import Any

from experiments.month import days
from experiments.month.program import Ended, kill_soon, needs, python, run

GRACE_SECONDS = 2 * 24 * 3600
PSNR_DB = 36.0
NUMBER_BOUND = 0.001
# The disk is full from this change of a file on: some of what a night writes is there by then.
FULL_FROM_CALL = 12
FULL_KIND = 3  # kFaultFull of tests/faults/faulty_files.h.
# An event-driven day keeps what changes. Each image links to the joints of its moment, which would
# be a change by itself.
EVENTS_CONFIG = """preset: balanced
entities:
  - match: Vision
    filters:
      - frequency: {rate: 5Hz}
      - similarity:
          images: {measure: ssim, bound: 0.98}
          remainder: ignore
          max_gap: 2s
    codecs:
      - {kind: image, codec: png}
"""


@dataclass(frozen=True)
class Night:
    """What every night of a store needs."""

    plan: days.Plan
    number: int
    engram: pathlib.Path
    raw: pathlib.Path  #: Folder of raw days.
    faults: pathlib.Path  #: The library that makes a disk full.
    folder: pathlib.Path  #: Has the store and what is kept beside it.
    representation: str
    usual_seconds: float  #: What a usual night takes; 0: unknown.

    @property
    def store(self) -> pathlib.Path:
        return self.folder / f"{self.representation}.engram"

    @property
    def seen(self) -> pathlib.Path:
        """What was read of the store after the night before."""
        return self.folder / f"{self.representation}.seen.npz"


def record(night: Night) -> dict[str, Any]:
    """Records the raw data of the night's day. Returns how many moments were offered and kept."""
    import engram

    day = days.RawDay.load(days.file_of(night.raw, night.number))
    how: dict[str, Any] = {"preset": "recorder"}
    if night.number == night.plan.events:
        how = {"config": night.folder / f"{night.representation}.events.yaml"}
        how["config"].write_text(EVENTS_CONFIG)
    with engram.record(night.store, **how) as recorder:
        for row, moment in enumerate(day.times):
            recorder.commit_all(
                [engram.recording.Update(days.JOINTS, {"position": day.joints[row]}, int(moment)),
                 engram.recording.Update(
                     days.CAMERA, {"image": day.images[row], "joints": link_to(int(moment))},
                     int(moment))])
        counts = recorder.counts
    # What filters hold is let go of when the recorder closes.
    with engram.open(night.store) as memory:
        kept = {name: len(memory[name].times(int(day.times[0]), int(day.times[-1])))
                for name in (days.CAMERA, days.JOINTS)}
    return {"offered": counts[days.CAMERA]["offered"], "kept": kept[days.CAMERA],
            "kept_joints": kept[days.JOINTS]}


def link_to(moment: int) -> str:
    """The joints of a moment, as a value links to them."""
    import numpy as np

    printed = str(np.datetime64(moment, "ns").astype("datetime64[us]")).replace("T", " ")
    return f"{days.JOINTS}/{printed}/0"


def limits_of(night: Night) -> list[str]:
    """How long a night may take, as options."""
    plan = night.plan
    if night.number == plan.short:
        return ["--budget", f"{plan.short_seconds:g}s"]
    if plan.short < night.number <= plan.short + 3 and plan.catching_up and night.usual_seconds:
        return ["--budget", f"{plan.catching_up * night.usual_seconds:.1f}s"]
    return ["--steps", str(plan.steps)]


def words_of(night: Night) -> list[Any]:
    since = time.time() - (days.begin_of(night.number) + days.NIGHT_AFTER_NS) / 1e9
    return [night.engram, "consolidate", night.store, "--representation", night.representation,
            "--psnr", PSNR_DB, "--number-bound", NUMBER_BOUND, "--threads", 1, *limits_of(night),
            "--drop-raw", "--grace", f"{since + GRACE_SECONDS:.0f}s", "--json", "--progress",
            "json"]


class Killer:
    """Kills a job so long after its progress said first that it is at work on images."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.is_aiming = False

    def watch(self, line: str, pid: int) -> None:
        if self.is_aiming or not line.startswith("{"):
            return
        what = json.loads(line)["what"]
        if what.startswith(("train", "encode")) and days.CAMERA in what:
            self.is_aiming = True
            kill_soon(pid, self.seconds)


def consolidate(night: Night) -> dict[str, Any]:
    """Runs the program for a night as the plan wants it, and says what that took."""
    plan, began = night.plan, time.monotonic()
    environment = {}
    if night.number == plan.full:
        environment = {"LD_PRELOAD": str(night.faults), "ENGRAM_FAULTS_ROOT": str(night.store),
                       "ENGRAM_FAULTS_CALL": str(FULL_FROM_CALL),
                       "ENGRAM_FAULTS_KIND": str(FULL_KIND)}
    ended = run(words_of(night), environment=environment,
                watch=Killer(plan.kill_after).watch if night.number == plan.killed else None)
    return {"seconds": time.monotonic() - began, "processor_seconds": ended.processor_seconds,
            "megabytes": ended.megabytes, **outcome_of(night, ended)}


def outcome_of(night: Night, ended: Ended) -> dict[str, Any]:
    """How a night ended, and what it told. A job that fails is found by a check, and the month goes
    on as a robot's would."""
    is_killed = night.number == night.plan.killed and ended.code == -signal.SIGKILL
    if ended.code != 0:
        return {"ended": "killed" if is_killed else f"with {ended.code}",
                "said": ended.err.strip().splitlines()[-1:], "entities": {}}
    return {"ended": "well", "entities": {
        one["entity"]: {"skipped": one["skipped"]} if "skipped" in one else
        {"snapshots": one["snapshots"], "waiting": one["waiting"],
         "is_model_new": one["is_model_new"], "model_version": one["model_version"],
         "notes": one["notes"],
         "stages": {name: spent["processor_seconds"] for name, spent in one["stages"].items()},
         "encodes": one["encodes"],
         "forms": {key: one["images"][f"{key}_rows"] for key in (
             "latent", "refined", "residual", "video", "lossless")} if one["images"] else None}
        for one in json.loads(ended.out)["entities"]}}


def sizes_of(store: pathlib.Path) -> dict[str, Any]:
    """Bytes and models of a store, as its manifest tells them."""
    file = store / "MANIFEST.json"
    manifest = json.loads(file.read_text())
    models: dict[str, int] = {}
    for model in manifest["models"]:
        models[model["entity"]] = models.get(model["entity"], 0) + 1
    images = sum(entity["stored_bytes"] for one in manifest["segments"] if one["kind"] == "latent"
                 for entity in one["entities"] if entity["id"] == days.CAMERA)
    images += sum(one["bytes"] for one in manifest["models"] if one["entity"] == days.CAMERA)
    return {"image_bytes": images,
            "latent_bytes": sum(one["bytes"] for one in manifest["segments"]
                                if one["kind"] == "latent"),
            "recorded_bytes": sum(one["bytes"] for one in manifest["segments"]
                                  if one["kind"] == "recorded"),
            "model_bytes": sum(model["bytes"] for model in manifest["models"]),
            "manifest_bytes": file.stat().st_size, "models": models}


def check(night: Night) -> list[str]:
    """Damage that `engram check` finds; empty where there is none."""
    ended = needs(run([night.engram, "check", night.store, "--json"]), "engram check", 0, 3)
    return [str(one) for one in json.loads(ended.out)["findings"] if one["severity"] == "fault"]


def pass_night(night: Night) -> dict[str, Any]:
    """A day and its night. Returns all figures of the store."""
    recorded = record(night)
    predicted = json.loads(python("predicting", night.store, night.raw, night.number))
    job = consolidate(night)
    read = json.loads(python("reading", night.store, night.raw, night.seen))
    return {"recorded": recorded, "predicted": predicted, "job": job, "read": read,
            "damage": check(night), "sizes": sizes_of(night.store)}
