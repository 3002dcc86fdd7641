# SPDX-License-Identifier: Apache-2.0
"""Conditions on place and context: are they met as brute force over all values says?

Random questions are asked about a store of kitchens: near a point, within a distance of another
object, in view of the camera, seen with it, looked for in vain, while a skill ran, linked to and
linked from something, each also negated, and some two at once. Brute force is written here anew,
from the values alone, in numpy. Every answer must have exactly the same moments.
"""
from __future__ import annotations

import argparse
import json
import pathlib
import random
import sys
import time
from typing import Any, Callable

import numpy as np
import numpy.typing as npt

ROOT = pathlib.Path(__file__).resolve().parents[2]
CAMERA = "Vision/RGB/head/stereo"
SKILLS = "Skill/Event/robot/"
EXAMPLES = """Examples:
  python3 -m experiments.recall.places --store build/recall/kitchens.engram
  python3 -m experiments.recall.places --store kitchen.engram --questions 500 --seed 3 --json out.json

Exit code: 0 where all answers are equal, 1 where one is not or something failed.
"""
Mask = npt.NDArray[np.bool_]


class Things:
    """What the store has, as columns."""

    def __init__(self, memory: Any) -> None:
        self.objects = {name: self._object(memory[name]) for name in memory.entities
                        if name.startswith(("Objects/Instances/", "Objects/Surfaces/"))}
        self.moving = [name for name in self.objects if "/Instances/" in name]
        times, poses, links = [], [], []
        for snapshot in memory[CAMERA].snapshots():
            times.append(snapshot.time)
            values = [one.value for one in snapshot.instances]
            poses.append([(value["pose_world_camera"]["position"],
                           value["pose_world_camera"]["orientation"]) for value in values])
            links.append([value["calibration"] for value in values])
        self.camera = np.array(times)
        self.eyes = np.array([[np.concatenate(pose) for pose in eyes] for eyes in poses])
        known: dict[str, list[float]] = {}
        self.lenses = np.array([[known.setdefault(link, lens_behind(memory, link)) for link in two]
                                for two in links])
        self.actions: dict[str, list[tuple[int, int]]] = {}
        self.linking: dict[str, set[tuple[str, int]]] = {}
        for snapshots in memory.query("Skill/Event @ all").values():
            for snapshot in snapshots:
                self._add_action(snapshot)

    @staticmethod
    def _object(entity: Any) -> dict[str, Any]:
        columns: dict[str, Any] = {"time": [], "at": [], "visible": [], "image": []}
        for snapshot in entity.snapshots():
            value = snapshot.value
            pose = next(value[key] for key in value if key.startswith("pose_world_"))
            columns["time"].append(snapshot.time)
            columns["at"].append(pose["position"])
            columns["visible"].append(value.get("is_visible", False))
            columns["image"].append(str(value.get("image", "")))
        return {name: np.array(column) for name, column in columns.items()}

    def _add_action(self, snapshot: Any) -> None:
        entity = snapshot.entity
        value = snapshot.value
        spans = self.actions.setdefault(entity, [])
        ended = value["ended"]
        known = [i for i, span in enumerate(spans) if span[0] == value["started"]]
        if known and ended is not None:
            spans[known[0]] = (value["started"], ended)
        elif not known:
            spans.append((value["started"], ended if ended is not None else -1))
        links = self.linking.setdefault(entity, set())
        for member in value.values():
            for text in member if isinstance(member, list) else [member]:
                # Parameters are JSON with names in it.
                if isinstance(text, str) and text.count("/") >= 4 and not text.startswith("{"):
                    names, moment, _ = text.rsplit("/", 2)
                    links.add((names, to_ns(moment)))


def to_ns(text: str) -> int:
    return int(np.datetime64(text.replace(" ", "T"), "ns").astype(np.int64))


def lens_behind(memory: Any, link: str) -> list[float]:
    names = "/".join(link.split("/")[:4])
    value = memory[names].snapshots().__next__().value
    return [float(value[key]) for key in ("fx", "fy", "cx", "cy", "width", "height")]


def last_until(times: npt.NDArray[np.int64], asked: npt.NDArray[np.int64]) -> Any:
    """The index of the last of `times` until each of `asked`; -1 if there is none."""
    return np.searchsorted(times, asked, side="right") - 1


def turned_back(q: npt.NDArray[np.float64], v: npt.NDArray[np.float64]) -> Any:
    """v [N, 3] turned by the inverses of unit quaternions w, x, y, z [N, 4]."""
    w, axis = q[:, :1], -q[:, 1:]
    t = 2 * np.cross(axis, v)
    return v + w * t + np.cross(axis, t)


class BruteForce:
    """Masks over the moments of an entity that is asked about."""

    def __init__(self, things: Things, asked: str) -> None:
        self._things = things
        self._asked = asked
        self.is_camera = asked == CAMERA
        self.times = things.camera if self.is_camera else things.objects[asked]["time"]

    def near(self, point: npt.NDArray[np.float64], radius: float) -> Mask:
        return np.sum((self._things.objects[self._asked]["at"] - point)**2, axis=1) <= radius**2

    def within(self, other: str, radius: float) -> Mask:
        one, two = self._things.objects[self._asked], self._things.objects[other]
        then = last_until(two["time"], self.times)
        apart = np.sum((one["at"] - two["at"][then])**2, axis=1)
        return (then >= 0) & (apart <= radius**2)

    def view(self, word: str, thing: str) -> Mask:
        """Of the camera if it is asked about, else of `thing`, which then is the asked entity."""
        one = self._things.objects[thing]
        if self.is_camera:
            looks, rows = np.arange(len(self.times)), last_until(one["time"], self.times)
        else:
            rows = np.arange(len(self.times))
            # Every object links to the image of its own time.
            looks = last_until(self._things.camera, self.times)
        met = np.zeros(len(rows), bool)
        exists = (looks >= 0) & (rows >= 0)
        for eye in range(self._things.eyes.shape[1]):
            # Objects link to the left image: only that one tells whether they were seen.
            if word != "in-view" and eye > 0:
                continue
            pose, lens = self._things.eyes[looks, eye], self._things.lenses[looks, eye]
            at = turned_back(pose[:, 3:], one["at"][rows] - pose[:, :3])
            with np.errstate(divide="ignore", invalid="ignore"):
                u = lens[:, 0] * at[:, 0] / at[:, 2] + lens[:, 2]
                v = lens[:, 1] * at[:, 1] / at[:, 2] + lens[:, 3]
                met |= ((at[:, 2] > 0) & (u >= -0.5) & (u < lens[:, 4] - 0.5) & (v >= -0.5)
                        & (v < lens[:, 5] - 0.5))
        if word == "seen-with":
            met &= one["visible"][rows]
        if word == "in-vain":
            met &= ~one["visible"][rows]
        return met & exists

    def during(self, skill: str) -> Mask:
        met = np.zeros(len(self.times), bool)
        spans = sorted(self._things.actions[skill])
        for i, (start, end) in enumerate(spans):
            if end < 0:
                end = spans[i + 1][0] - 1 if i + 1 < len(spans) else 2**63 - 1
            met |= (self.times >= start) & (self.times <= end)
        return met

    def linked_to(self, image: str) -> Mask:
        return self._things.objects[self._asked]["image"] == image

    def linked_from(self, skill: str) -> Mask:
        wanted = [at for names, at in self._things.linking[skill] if names == self._asked]
        return np.isin(self.times, wanted)


def condition(things: Things, asked: str, draw: random.Random) -> tuple[str, Mask]:
    """A random condition on an entity, and which of its moments meet it."""
    brute = BruteForce(things, asked)
    other = draw.choice(things.moving)
    radius = round(draw.uniform(0.02, 1.5), 3)
    kinds: list[Callable[[], tuple[str, Mask]]] = []

    def add_view(word: str) -> None:
        thing = other if brute.is_camera else asked
        target = other if brute.is_camera else CAMERA
        kinds.append(lambda: (f"{word} {target}", brute.view(word, thing)))

    for word in ("in-view", "seen-with", "in-vain"):
        add_view(word)
    skill = draw.choice(sorted(things.actions))
    kinds.append(lambda: (f"while {skill}", brute.during(skill)))
    kinds.append(lambda: (f"links-from {skill}", brute.linked_from(skill)))
    if not brute.is_camera:
        spot = things.objects[other]["at"][draw.randrange(len(things.objects[other]["at"]))]
        point = np.round(spot, 2)
        text = ",".join(f"{x:g}" for x in point)
        target = draw.choice(sorted(things.objects))
        image = things.objects[asked]["image"][draw.randrange(len(brute.times))]
        kinds.append(lambda: (f"near {text} {radius}m", brute.near(point, radius)))
        kinds.append(lambda: (f"within {target} {radius}m", brute.within(target, radius)))
        kinds.append(lambda: (f"linked-to {image}", brute.linked_to(image)))
    text, mask = draw.choice(kinds)()
    if draw.random() < 0.2:
        return f"not {text}", ~mask
    return text, mask


def main() -> int:
    parser = argparse.ArgumentParser(prog="python3 -m experiments.recall.places",
                                     description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--store", type=pathlib.Path, default=ROOT / "build/recall/kitchens.engram",
                        help="of kitchens (build/recall/kitchens.engram)")
    parser.add_argument("--questions", type=int, default=10_000, help="how many (10000)")
    parser.add_argument("--seed", type=int, default=1, help="of the questions (1)")
    parser.add_argument("--json", type=pathlib.Path, help="all figures")
    given = parser.parse_args()
    import engram

    draw = random.Random(given.seed)
    wrong: list[str] = []
    seconds, met, all_moments = [], 0, 0
    with engram.open(given.store) as memory:
        things = Things(memory)
        entities = [CAMERA, *things.moving]
        for number in range(given.questions):
            asked = draw.choice(entities) if draw.random() < 0.7 else CAMERA
            text, mask = condition(things, asked, draw)
            if draw.random() < 0.3:
                more, other = condition(things, asked, draw)
                text, mask = f"{text} {more}", mask & other
            expected = BruteForce(things, asked).times[mask]
            begin = time.process_time()
            answer = memory[asked].times(where=text).astype(np.int64)
            seconds.append(time.process_time() - begin)
            met += len(answer)
            all_moments += len(mask)
            if not np.array_equal(answer, expected):
                wrong.append(f"{asked} @ all {text}: {len(answer)} moments, needs {len(expected)}")
            if sys.stderr.isatty() and number % 100 == 0:
                print(f"\r{number} of {given.questions}", end="", file=sys.stderr, flush=True)
    figures = {"questions": given.questions, "wrong": len(wrong), "moments": len(things.camera),
               "met_share": met / all_moments, "median_ms": 1e3 * float(np.median(seconds)),
               "p99_ms": 1e3 * float(np.quantile(seconds, 0.99))}
    print(f"conditions: {given.questions - len(wrong)} of {given.questions} answers equal brute force  "
          f"({'reached' if not wrong else 'MISSED'}: needs all); {100 * figures['met_share']:.1f} % of "
          f"the moments were met; {figures['median_ms']:.1f} ms of processor time in the median, "
          f"{figures['p99_ms']:.1f} ms p99, of {len(things.camera):,} images")
    for one in wrong[:10]:
        print(f"  {one}")
    if given.json:
        given.json.write_text(json.dumps({**figures, "first_wrong": wrong[:10]}, indent=1))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
