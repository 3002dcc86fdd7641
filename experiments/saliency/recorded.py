# SPDX-License-Identifier: Apache-2.0
"""How wrong a tenth of the snapshots of real recordings is about all moments.

Nobody said what happened in them, so there are no questions. Instead the joints and the image of
every moment are told by the last one that was kept before it. The figures are the root mean squared
errors: of joints each standardised, of images in grey levels.
"""
import pathlib
import subprocess

import numpy as np

CAMERA = "Vision/RGB/head/cam"
JOINTS = "RobotState/Proprioception/robot/joints"


def record(engram, recordings, store):
    """Videos of one camera and tables of joints with the same names; each begins a minute later."""
    videos = sorted(recordings.rglob("*cam_high/*.mp4"))
    tables = {path.stem: path for path in recordings.rglob("*.csv")}
    for minute, video in enumerate(video for video in videos if video.stem in tables):
        subprocess.run([str(engram), "-q", "import", "--video", str(video), "--table",
                        str(tables[video.stem]), "--state-entity", JOINTS, "--skip-column",
                        "frame_index", "--entity", CAMERA, "--size", "128x128", "--rate", "5",
                        "--start", f"2022-02-18T13:{minute:02d}Z", str(store)], check=True)


class Moments:
    """The joints and images of all moments of a store. Shape: joints [N, D], images [M, H W C]."""

    def __init__(self, memory):
        joints, images = memory[JOINTS], memory[CAMERA]
        self.times = {JOINTS: joints.times().astype("int64"), CAMERA: images.times().astype("int64")}
        rows = [one.value for one in memory.query(f"{JOINTS} @ all")[JOINTS]]
        values = np.array([list((row.get("state") or row).values()) for row in rows], float)
        self.values = {JOINTS: (values - values.mean(0)) / (values.std(0) + 1e-3)}
        self.values[CAMERA] = np.array([one.image for one in images.snapshots()], np.float32)

    def error(self, entity, kept):
        """The error of all moments, each told by the last kept one before it."""
        times, values = self.times[entity], self.values[entity]
        places = np.flatnonzero(np.isin(times, list(kept)))
        if len(places) == 0:
            return float("nan")
        told = places[np.maximum(np.searchsorted(places, np.arange(len(times)), "right") - 1, 0)]
        return float(np.sqrt(((values - values[told]) ** 2).mean()))


def measure(options, engram, rivals, forget, times_of):
    """The errors of each way to keep a share, by entity."""
    full, small = options.work / "recorded.engram", options.work / "recorded-salient.engram"
    if not full.exists():
        record(options.engram, options.recordings, full)
    subprocess.run([str(options.engram), "why-salient", str(full), JOINTS, "--keep", "--json"],
                   check=True, stdout=subprocess.DEVNULL)
    forget(options, full, small)
    with engram.open(full) as memory:
        moments, times = Moments(memory), times_of(memory)
    with engram.open(small) as memory:
        kept = {"salient": times_of(memory)}
    kept |= {name: rival(times, options.share) for name, rival in rivals.items()}
    return {"snapshots": sum(len(one) for one in times.values()),
            "stores": {name: {"kept": sum(len(one) for one in of.values()),
                              "joints": moments.error(JOINTS, of.get(JOINTS, ())),
                              "images": moments.error(CAMERA, of.get(CAMERA, ()))}
                       for name, of in kept.items()}}


def show(result):
    print(f"\nrecordings: {result['snapshots']:,} snapshots; errors of what is told of all moments\n"
          "\n| store | kept | joints | images |\n|---|---|---|---|")
    for name, one in result["stores"].items():
        print(f"| {name} | {one['kept']:,} | {one['joints']:.3f} | {one['images']:.1f} |")
