# SPDX-License-Identifier: Apache-2.0
"""Real recordings have no phases of a task, but joints: how far apart are those of a moment and of
the moment that is found for it in another recording?

All recordings are coded together, as a night does it. The distance of two moments is the root mean
square difference of their joint positions, each standardised. No method is told the joints of the
moment that is asked with; codes have learned from joints of all recordings which images belong
together.
"""
from __future__ import annotations

import pathlib
import subprocess
from typing import Any

import numpy as np
import numpy.typing as npt

CAMERA = "Vision/RGB/head/cam"
JOINTS = "RobotState/Proprioception/robot/joints"
LAGS = (0, 0.2, 0.6, 1.0, 2.0)


def record(engram: pathlib.Path, recordings: pathlib.Path, store: pathlib.Path) -> None:
    """Videos of one camera and tables of joints with the same names; each begins a minute later."""
    if (store / "MANIFEST.json").exists():
        return
    videos = sorted(recordings.rglob("*cam_high/*.mp4"))
    tables = {path.stem: path for path in recordings.rglob("*.csv")}
    for minute, video in enumerate(video for video in videos if video.stem in tables):
        subprocess.run([str(engram), "-q", "import", "--video", str(video),
                        "--table", str(tables[video.stem]), "--state-entity", JOINTS,
                        "--skip-column", "frame_index", "--entity", CAMERA, "--size", "128x128",
                        "--rate", "5", "--start", f"2022-02-18T13:{minute:02d}Z", str(store)],
                       check=True)
    subprocess.run([str(engram), "similar", str(store), CAMERA, "--keep", "-k", "1"], check=True,
                   stdout=subprocess.DEVNULL)


class Recorded:
    def __init__(self, memory: Any) -> None:
        self.camera = memory[CAMERA]
        self.times = self.camera.times().astype(np.int64)
        images = np.array([self.camera.at(int(one)).image for one in self.times], np.float32)
        cells = images.reshape(len(images), 16, 8, 16, 8, 3).mean(axis=(2, 4))
        self.thumbnails = cells.reshape(len(images), -1)
        states = [memory[JOINTS].nearest(int(one)).value["state"] for one in self.times]
        joints = np.array([list(state.values()) for state in states])
        self.joints = (joints - joints.mean(axis=0)) / (joints.std(axis=0) + 1e-3)
        self.recordings = np.cumsum(np.diff(self.times, prepend=self.times[0]) > 5 * 10**9)

    def others(self, one: int) -> npt.NDArray[np.int64]:
        return np.flatnonzero(self.recordings != self.recordings[one])

    def distance(self, one: int, found: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
        return np.sqrt(((self.joints[one] - self.joints[found]) ** 2).mean(axis=-1))

    def by_thumbnails(self, has_context: bool) -> float:
        features = self.thumbnails
        if has_context:
            first = np.searchsorted(self.recordings, self.recordings)
            before = [np.maximum(np.searchsorted(self.times, self.times - int(lag * 1e9), "right")
                                 - 1, first) for lag in LAGS]
            features = np.concatenate([features[one] for one in before], axis=1)
        found = [self.others(one)[np.argmin(((features[self.others(one)] - features[one]) ** 2)
                                            .sum(axis=1))] for one in range(len(features))]
        return float(np.mean([self.distance(one, found[one]) for one in range(len(found))]))

    def by_codes(self, context: float) -> float:
        place = {int(time): index for index, time in enumerate(self.times)}
        found = [place[self.camera.similar(int(time), 1, elsewhere=True, apart=0,
                                           context=context)[0].time] for time in self.times]
        return float(np.mean([self.distance(one, found[one]) for one in range(len(found))]))


def measure(memory: Any) -> dict[str, float]:
    recorded = Recorded(memory)
    everyone = range(len(recorded.times))
    distances = [recorded.distance(one, recorded.others(one)) for one in everyone]
    return {"random": float(np.mean([one.mean() for one in distances])),
            "the nearest joints there are": float(np.mean([one.min() for one in distances])),
            "thumbnails": recorded.by_thumbnails(False),
            "thumbnails, with context": recorded.by_thumbnails(True),
            "codes, the image alone": recorded.by_codes(0),
            "codes": recorded.by_codes(2)}
