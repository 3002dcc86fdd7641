# SPDX-License-Identifier: Apache-2.0
"""The stores that experiments measure: recordings of a folder, else of a simulated kitchen.

All have a camera entity of single images at 5 Hz, offered at the recording's own rate, and numbers
in entities of one unit each, so that an RMSE over an entity has a unit.
"""

from __future__ import annotations

import csv
import pathlib
import shutil
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from experiments.paper.measuring import Measuring, file_fingerprint, fingerprint

CAMERA = "Vision/RGB/head/cam"
RATE_HZ = 5
RECORDING_GAP_NS = 10_000_000_000
START_NS = 1_645_189_200_000_000_000  # 2022-02-18 13:00 UTC; recordings lie a minute apart.


@dataclass(frozen=True)
class Dataset:
    """`kind`: g1 (videos with tables of joints), clip (one video) or kitchen (simulated)."""

    name: str
    kind: str
    title: str
    options: dict[str, Any]

    @property
    def is_recorded(self) -> bool:
        return self.kind != "kitchen"


def datasets(measuring: Measuring) -> list[Dataset]:
    """Those of the configuration; what stands in for them where there are no recordings."""
    folder = measuring.recordings
    has_recordings = folder is not None and folder.is_dir()
    wanted = measuring.config["datasets" if has_recordings else "without_recordings"]
    if not has_recordings:
        measuring.say(f"no recordings at '{folder or ''}': a simulated kitchen")
    return [Dataset(one["name"], one["kind"], one["title"], one) for one in wanted]


def make_store(measuring: Measuring, dataset: Dataset, side: int) -> tuple[pathlib.Path, str]:
    """A store of its images, `side` pixels wide and high, and of its numbers. The second value
    tells what it was made of."""
    makers: dict[str, Callable[[Measuring, Dataset, int, pathlib.Path], None]] = {
        "g1": _make_g1, "clip": _make_clip, "kitchen": _make_kitchen}
    about = {"kind": dataset.kind, "side": side, "version": 1, "files": [
        file_fingerprint(file) for file in _files(measuring, dataset)]} | {
            key: dataset.options.get(key) for key in ("episodes", "seeds", "seconds", "most_s")}
    key = fingerprint(about)
    path = measuring.folder / "stores" / f"{dataset.name}-{side}-{key}.engram"
    if not path.exists():
        path.parent.mkdir(exist_ok=True)
        new = path.with_suffix(".new")
        shutil.rmtree(new, ignore_errors=True)
        measuring.say(f"record {dataset.title}, {side} x {side}")
        makers[dataset.kind](measuring, dataset, side, new)
        new.rename(path)
    return path, key


def entity_bytes(measuring: Measuring, store: pathlib.Path) -> dict[str, dict[str, Any]]:
    """What `engram info` says of each entity."""
    return {one["id"]: one for one in measuring.report("info", store)["entities"]}


def recordings_of(store: pathlib.Path, entity: str) -> list[npt.NDArray[np.int64]]:
    """Times of its snapshots in ns, one array for each recording: between them is a gap."""
    import engram

    with engram.open(store) as memory:
        times = memory[entity].times().astype(np.int64)
    return np.split(times, 1 + np.flatnonzero(np.diff(times) >= RECORDING_GAP_NS))


def _files(measuring: Measuring, dataset: Dataset) -> list[pathlib.Path]:
    if dataset.kind == "kitchen":
        return []
    assert measuring.recordings is not None
    found = sorted(measuring.recordings.rglob(dataset.options["files"]))
    found = found[:dataset.options.get("episodes") or len(found)]
    if not found:
        sys.exit(f"recordings: no {dataset.options['files']} below {measuring.recordings}")
    return found


def _start(number: int) -> str:
    return f"2022-02-18T13:{number:02d}Z"


def _make_g1(measuring: Measuring, dataset: Dataset, side: int, new: pathlib.Path) -> None:
    tables = []
    for minute, video in enumerate(_files(measuring, dataset)):
        measuring.run("import", "--video", video, "--entity", CAMERA, "--size", f"{side}x{side}",
                      "--rate", RATE_HZ, "--start", _start(minute), new)
        assert measuring.recordings is not None
        tables.append(next(iter(sorted(measuring.recordings.rglob(video.stem + ".csv")))))
    _commit_numbers(new, _g1_numbers(tables), 30)


def _g1_numbers(tables: list[pathlib.Path]) -> Iterator[tuple[str, int, Any]]:
    """Arms in rad, hands from 0 (closed) to 1 (open), as measured by the robot."""
    for minute, file in enumerate(tables):
        with open(file, encoding="ascii", newline="") as lines:
            rows = list(csv.DictReader(lines))
        names = [name for name in rows[0] if name.startswith("state.")]
        arms = [name for name in names if "Hand" not in name]
        hands = [name for name in names if "Hand" in name]
        for row in rows:
            time = START_NS + minute * 60_000_000_000 + round(1e9 * float(row["timestamp"]))
            for entity, members in (("arms", arms), ("hands", hands)):
                values = np.array([float(row[name]) for name in members])
                yield f"RobotState/Proprioception/robot/{entity}", time, {"positions": values}


def _make_clip(measuring: Measuring, dataset: Dataset, side: int, new: pathlib.Path) -> None:
    video = _files(measuring, dataset)[0]
    measuring.run("import", "--video", video, "--entity", CAMERA, "--crop-square", "--size",
                  f"{side}x{side}", "--rate", RATE_HZ, "--start", _start(0), new)


def _make_kitchen(measuring: Measuring, dataset: Dataset, side: int, new: pathlib.Path) -> None:
    """The left camera and numbers of a simulated kitchen, a recording per seed, committed once
    more as entities of one unit each."""
    import engram

    whole = new.with_suffix(".whole")
    shutil.rmtree(whole, ignore_errors=True)
    size = ["--fast"] if side == 128 else ["--width", str(side), "--height", str(side)]
    measuring.run("simulate", "kitchen", whole, *size, "--seconds", dataset.options["seconds"],
                  "--seed", dataset.options["seeds"])
    with engram.open(whole) as memory:
        thing = _most_moved(memory)
        joints = "RobotState/Proprioception/robot/joints"
        platform = "RobotState/Localization/robot/platform"

        def values() -> Iterator[tuple[str, int, Any]]:
            for one in memory["Vision/RGB/head/stereo"].snapshots():
                yield CAMERA, one.time, {"image": one.image}
            for one in memory[joints].snapshots():
                yield joints, one.time, {"positions": one.value["positions"]}
            for one in memory[platform].snapshots():
                place = one.value["pose_world_platform"]
                yield "RobotState/Localization/robot/position", one.time, {"xy": place[:2]}
                yield "RobotState/Localization/robot/heading", one.time, {"angle": place[2:]}
            for one in memory[thing].snapshots():
                place = np.asarray(one.value["pose_world_object"]["position"])
                yield "Objects/Instances/kitchen/thing_position", one.time, {"xyz": place.ravel()}

        _commit_numbers(new, values(), 20)
    shutil.rmtree(whole)


def _most_moved(memory: Any) -> str:
    """The object that goes farthest of those that are in as many recordings as any."""
    ways: dict[str, tuple[int, float]] = {}
    for name in memory.entities:
        if name.startswith("Objects/Instances/"):
            places = np.array([one.value["pose_world_object"]["position"]
                               for one in memory[name].snapshots()])
            times = memory[name].times().astype(np.int64)
            steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
            is_within = np.diff(times) < 60_000_000_000
            ways[name] = (1 + int((~is_within).sum()), float(steps[is_within].sum()))
    return max(ways, key=lambda name: ways[name])


def _commit_numbers(store: pathlib.Path, values: Iterator[tuple[str, int, Any]],
                    rate_hz: float) -> None:
    """Through the online phase: 5 Hz are kept of what comes."""
    import engram

    config = store.with_suffix(".yaml")
    config.write_text(f"entities:\n  - match: .*\n    filters:\n"
                      f"      - frequency: {{rate: {RATE_HZ}Hz}}\n")
    try:
        with engram.record(store, config=config) as recorder:
            for entity, time, value in values:
                recorder.commit(entity, value, time)
    finally:
        config.unlink()
