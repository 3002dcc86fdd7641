# SPDX-License-Identifier: Apache-2.0
"""When was it like this before? How often likeness finds the same phase of a task elsewhere.

Kitchens of two groups of seeds are recorded into one store. A night codes the first group, and what
it learned there codes the second, which it has not seen. For five moments a second of the second
group in which a skill is running, the nearest moment of another recording of this group is asked
for. It counts as found if the same skill runs there at the same place ("pick at the counter": seven
phases). All methods choose among the same moments: those of the group in which a skill runs.

Thumbnails have 16 x 16 pixels and are compared by the sum of squared differences; alone, with what
came before as codes are compared, and with the mean of their recording taken off, too.
"""
from __future__ import annotations

import argparse
import json
import pathlib
import subprocess
import sys
import time
from typing import Any

import numpy as np
import numpy.typing as npt

from experiments.recall import joints

ROOT = pathlib.Path(__file__).resolve().parents[2]
CAMERA = "Vision/RGB/head/stereo"
JOINTS = "RobotState/Proprioception/robot/joints"
LAGS = (0, 0.2, 0.6, 1.0, 2.0)  #: Seconds before a moment, as the context of codes.
EXAMPLES = """Examples:
  python3 -m experiments.recall                            23 recordings of a minute, half an hour
  python3 -m experiments.recall --learned 1..4 --asked 5..8 --seconds 30 --work /tmp/recall
  python3 -m experiments.recall --recordings ../shared/data/g1 --json recall.json

Exit code: 0 where likeness makes at most half of the errors of thumbnails, 1 where it does not or
something failed.
"""


def arguments_of(words: list[str] | None = None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python3 -m experiments.recall", description=__doc__,
                                     epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--engram", type=pathlib.Path, default=ROOT / "build/release/bin/engram",
                        help="the program (build/release/bin/engram); PYTHONPATH has its package")
    parser.add_argument("--learned", default="13..24",
                        help="seeds that are learned from (13..24)")
    parser.add_argument("--asked", default="25..35",
                        help="seeds that are asked about (25..35)")
    parser.add_argument("--seconds", type=float, default=60, help="of each recording (60)")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/recall",
                        help="folder of the store, which is used again (build/recall)")
    parser.add_argument("--recordings", type=pathlib.Path,
                        help="a folder of real recordings (../shared/data/g1); none without it")
    parser.add_argument("--json", type=pathlib.Path, help="all figures")
    return parser.parse_args(words)


def seeds_of(text: str) -> tuple[int, int]:
    """ "14..25" as the first and the last."""
    first, _, last = text.partition("..")
    return int(first), int(last or first)


def record(given: argparse.Namespace, store: pathlib.Path) -> None:
    """Each group is coded before the next one comes, as in two nights."""
    for name in ("learned", "asked"):
        seeds = getattr(given, name)
        mark = store.with_suffix(f".{name}.{seeds}.{given.seconds}")
        if mark.exists():
            continue
        for words in (["simulate", "kitchen", str(store), "--fast", "--seed", seeds, "--seconds",
                       str(given.seconds)],
                      ["similar", str(store), CAMERA, "--keep", "-k", "1"]):
            subprocess.run([str(given.engram), *words], check=True, stdout=subprocess.DEVNULL)
        mark.touch()


class Asked:
    """The moments of the asked group in which a skill runs, and what is known of them."""

    def __init__(self, memory: Any, first: int, end: int) -> None:
        actions = self._actions(memory, first, end)
        self.among = "Vision @ " + ", ".join(f"time:{a}..{b - 1}" for a, b, _ in actions)
        camera = memory[CAMERA]
        times, phases, thumbnails = [], [], []
        for snapshot in camera.snapshots(first, end):
            thumbnails.append(thumbnail(snapshot.instances[0].value["image"]))
            times.append(snapshot.time)
            running = [phase for a, b, phase in actions if a <= snapshot.time < b]
            phases.append(running[0] if running else "")
        self.times = np.array(times)
        self.phases = np.array(phases)
        self.thumbnails = np.array(thumbnails)
        # A recording begins an hour after the one before it.
        self.recordings = np.cumsum(np.diff(self.times, prepend=self.times[0]) > 60 * 10**9)
        self.choices = np.flatnonzero(self.phases != "")
        is_fifth = (self.times - first) % (200 * 10**6) == 0
        self.questions = np.flatnonzero(is_fifth & (self.phases != ""))

    @staticmethod
    def _actions(memory: Any, first: int, end: int) -> list[tuple[int, int, str]]:
        found = []
        for snapshots in memory.query("Skill/Event @ all").values():
            for snapshot in snapshots:
                action = snapshot.value
                if action["ended"] is None or not first <= snapshot.time <= end:
                    continue
                place = (action["surface"] or "").split("/")[-1]
                found.append((action["started"], action["ended"], f"{action['skill']} {place}"))
        return sorted(found)

    def others(self, question: int) -> npt.NDArray[np.int64]:
        """The moments that may be the answer."""
        return self.choices[self.recordings[self.choices] != self.recordings[question]]

    def share_found(self, answers: npt.NDArray[np.int64]) -> float:
        return float(np.mean(self.phases[answers] == self.phases[self.questions]))


def thumbnail(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
    height, width, channels = image.shape
    cells = image.reshape(16, height // 16, 16, width // 16, channels)
    return cells.mean(axis=(1, 3), dtype=np.float32).ravel()


def random_share(asked: Asked) -> float:
    """What choosing at random finds on average."""
    return float(np.mean([np.mean(asked.phases[asked.others(one)] == asked.phases[one])
                          for one in asked.questions]))


def before(asked: Asked, lag: float) -> npt.NDArray[np.int64]:
    """For each moment the one `lag` seconds before it, or the first of its recording."""
    index = np.searchsorted(asked.times, asked.times - int(lag * 1e9), side="right") - 1
    first = np.searchsorted(asked.recordings, asked.recordings)
    return np.maximum(index, first)


def thumbnail_answers(asked: Asked, has_context: bool, is_centred: bool) -> npt.NDArray[np.int64]:
    features = asked.thumbnails.copy()
    if is_centred:
        for recording in np.unique(asked.recordings):
            own = asked.recordings == recording
            features[own] -= features[own].mean(axis=0)
    if has_context:
        features = np.concatenate([features[before(asked, lag)] for lag in LAGS], axis=1)
    squares = (features**2).sum(axis=1)
    answers = []
    for one in asked.questions:
        others = asked.others(one)
        distances = squares - 2 * features @ features[one]
        answers.append(others[np.argmin(distances[others])])
    return np.array(answers)


def code_answers(memory: Any, asked: Asked, **options: Any) -> npt.NDArray[np.int64]:
    camera = memory[CAMERA]
    answers = []
    for one in asked.questions:
        found = camera.similar(int(asked.times[one]), 1, elsewhere=True, among=asked.among,
                               apart=0, **options)
        answers.append(np.searchsorted(asked.times, found[0].time))
    return np.array(answers)


def measure(memory: Any, asked: Asked) -> dict[str, float]:
    shares = {"random": random_share(asked)}
    shares["thumbnails"] = asked.share_found(thumbnail_answers(asked, False, False))
    shares["thumbnails, with context"] = asked.share_found(thumbnail_answers(asked, True, False))
    shares["thumbnails, with context, centred"] = asked.share_found(
        thumbnail_answers(asked, True, True))
    shares["codes, the image alone"] = asked.share_found(code_answers(memory, asked, context=0))
    shares["codes"] = asked.share_found(code_answers(memory, asked))
    shares["codes, joints beside them"] = asked.share_found(
        code_answers(memory, asked, beside={JOINTS: 0.5}))
    return shares


def main() -> int:
    given = arguments_of()
    import engram

    store = given.work / "kitchens.engram"
    given.work.mkdir(parents=True, exist_ok=True)
    record(given, store)
    first_seed, last_seed = seeds_of(given.asked)
    hour = 3600 * 10**9
    start = int(np.datetime64("2026-01-01T07:00").astype("datetime64[ns]").astype(np.int64))
    with engram.open(str(store)) as memory:
        asked = Asked(memory, start + first_seed * hour,
                      start + last_seed * hour + int(given.seconds * 1e9))
        begun = time.process_time()
        shares = measure(memory, asked)
        seconds = time.process_time() - begun
    print(f"{len(asked.questions)} moments of {len(set(asked.recordings))} recordings, "
          f"{len(set(asked.phases)) - 1} phases, {seconds:.0f} s of processor time")
    errors = 1 - shares["thumbnails"]
    for name, share in shares.items():
        print(f"  {name:40} found {100 * share:5.1f} %   errors {100 * (1 - share):5.1f} %   "
              f"{(1 - share) / errors:.2f} of those of thumbnails")
    is_reached = 1 - shares["codes"] <= errors / 2
    print("bar: half of the errors of thumbnails:", "reached" if is_reached else "missed")
    distances = {}
    if given.recordings:
        real = given.work / "recordings.engram"
        joints.record(given.engram, given.recordings, real)
        with engram.open(str(real)) as memory:
            distances = joints.measure(memory)
        print("joints of what is found in another recording, standardised, are so far apart:")
        for name, distance in distances.items():
            print(f"  {name:40} {distance:.3f}")
    if given.json:
        given.json.write_text(json.dumps({"questions": len(asked.questions), "found": shares,
                                          "joints": distances}, indent=1))
    return 0 if is_reached else 1


if __name__ == "__main__":
    sys.exit(main())
