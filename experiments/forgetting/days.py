# SPDX-License-Identifier: Apache-2.0
"""Days of the simulated kitchen: a store of all of them, and the truth of each.

A day is a short recording in a kitchen of its own: objects, light, words and mishaps follow from
the seed. Ages count back from `today`: the last day is the day before it.

The simulator records without loss. The truth is read from that, before anything is consolidated.
To be sure that it is the simulator's, some days are simulated again into plain files, which no
store and no codec has seen, and compared to the last bit.
"""
import dataclasses
import datetime
import json
import pathlib
import shutil
import subprocess
import sys
import time

import numpy as np

SECOND = 1_000_000_000  # Unit: ns.
IMAGE_PERIOD = 400_000_000  # What the recording below keeps of images. Unit: ns.
STATE_PERIOD = 200_000_000  # Truth of the platform; objects come at this rate. Unit: ns.
SIDE = 128  # Pixels of an image with --fast.
CAMERA = "Vision/RGB/head/stereo"
PLATFORM = "RobotState/Localization/robot/platform"
SPEECH = "Speech/Commands/human/text"
OBJECTS = "Objects/Instances/kitchen"
ACTIONS = "Skill/Event/robot"
RECORDING = """entities:
  - match: Vision
    filters: [{frequency: {rate: 2500mHz}}]
"""


class Failed(Exception):
    """A program failed, or what it made is not what is needed."""


def tell(text):
    print(text, file=sys.stderr, flush=True)


def run(*words):
    """What a program prints, as text."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0:
        raise Failed(f"{' '.join(map(str, words[:3]))} ended with {done.returncode}: "
                     f"{done.stderr[-500:]}")
    return done.stdout


class Progress:
    """Tells on stderr what is done, with the time left."""

    def __init__(self, what, total):
        self.what, self.total, self.done = what, total, 0
        self.start = time.monotonic()

    def step(self):
        self.done += 1
        each = (time.monotonic() - self.start) / self.done
        tell(f"{self.what}: {self.done} of {self.total}, "
             f"{each * (self.total - self.done) / 60:.1f} min left")


@dataclasses.dataclass(frozen=True)
class Plan:
    """Which days are simulated."""

    days: int
    seed: int
    seconds: float
    today: datetime.date

    def seed_of(self, day):
        return self.seed * 1000 + day

    def start_of(self, day):
        """Begin of a day's recording, in the morning or the afternoon. Unit: ns since 1970."""
        begin = datetime.datetime.combine(self.today - datetime.timedelta(days=self.days - day),
                                          datetime.time(7 + (self.seed + 5 * day) % 12),
                                          datetime.timezone.utc)
        return int(begin.timestamp()) * SECOND

    def end_of(self, day):
        return self.start_of(day) + int(self.seconds * SECOND) - 1

    @property
    def now(self):
        """The moment to which ages count. Unit: ns since 1970."""
        begin = datetime.datetime.combine(self.today, datetime.time(), datetime.timezone.utc)
        return int(begin.timestamp()) * SECOND

    def options(self, day):
        start = datetime.datetime.fromtimestamp(self.start_of(day) // SECOND, datetime.timezone.utc)
        return ["--fast", "--seed", self.seed_of(day), "--seconds", self.seconds, "--start",
                f"{start:%Y-%m-%dT%H:%M:%SZ}", "--progress", "none"]


def record(engram, plan, store, work):
    """Records all days into a store, one after the other."""
    config = work / "recording.yaml"
    config.write_text(RECORDING)
    progress = Progress("days recorded", plan.days)
    for day in range(plan.days):
        run(engram, "simulate", "kitchen", store, "--config", config, *plan.options(day))
        progress.step()


def name_of(link):
    """The object's name in a link to an instance."""
    return link.split("/")[3].removesuffix("_1") if link else None


def skill_of(value):
    """The skill of an event, without its provider."""
    return value["skill"].rpartition("/")[2]


def truth_of(rows_of):
    """What happened on a day. `rows_of` gives names and rows (time, value) below an ID."""
    return {
        "objects": {name.removesuffix("_1"): [
            {"time": when, "position": [float(x) for x in value["pose_world_object"]["position"]],
             "is_visible": bool(value["is_visible"]), "held_by": value["held_by"]}
            for when, value in rows] for name, rows in rows_of(OBJECTS)},
        "actions": sorted(({"time": when, "skill": skill_of(value), "started": int(value["started"]),
                            "ended": value["ended"] and int(value["ended"]),
                            "outcome": int(value["outcome"]),
                            "object": name_of(value["object_before"])}
                           for _, rows in rows_of(ACTIONS) for when, value in rows),
                          key=lambda action: (action["time"], action["started"])),
        "platform": [{"time": when,
                      "position": [float(x) for x in value["pose_world_platform"][:2]]}
                     for _, rows in rows_of(PLATFORM) for when, value in rows
                     if when % STATE_PERIOD == 0],
        "speech": [{"time": when, "text": value["text"]}
                   for _, rows in rows_of(SPEECH) for when, value in rows]}


def recorded_truth(memory, plan, day):
    """The truth of a day, as a store has it that was not consolidated yet."""
    begin, end = plan.start_of(day), plan.end_of(day)

    def rows_of(what):
        found = sorted(name for name in memory.entities if (name + "/").startswith(what + "/"))
        for name in found:
            rows = [(one.time, one.value) for one in memory[name].snapshots(begin, end)]
            if rows:
                yield name.rsplit("/", 1)[1], rows

    truth = truth_of(rows_of)
    images = [(one.time, one.image.copy()) for one in memory[CAMERA].snapshots(begin, end)]
    truth["image_times"] = [when for when, _ in images]
    return truth, np.stack([image for _, image in images])


def write_truth(package, plan, store, folder):
    """Writes the truth of each day, as files that questions are made of."""
    folder.mkdir(parents=True, exist_ok=True)
    with package.open(str(store)) as memory:
        for day in range(plan.days):
            truth, images = recorded_truth(memory, plan, day)
            np.save(folder / f"{day}.npy", images)
            (folder / f"{day}.json").write_text(json.dumps(truth))


def read_truth(folder):
    """The truth of all days. Images are read from the disk where they are needed."""
    days = []
    for number in range(len(list(pathlib.Path(folder).glob("*.json")))):
        truth = json.loads((folder / f"{number}.json").read_text())
        truth["images"] = np.load(folder / f"{number}.npy", mmap_mode="r")
        days.append(truth)
    return days


def plain_value(value):
    """A value of a plain file without the marks of its types."""
    if isinstance(value, list):
        return [plain_value(one) for one in value]
    if not isinstance(value, dict):
        return value
    if len(value) == 1:
        (key, inner), = value.items()
        if key == "$ndarray":
            return inner["data"]
        if key.startswith("$int"):
            return int(inner)
        if key.startswith("$"):
            return plain_value(inner)
    return {key: plain_value(one) for key, one in value.items()}


def moments_of(entity):
    return sorted(entity.iterdir(), key=lambda path: int(path.name))


def plain_truth(folder):
    """The truth of a day and its images, from plain files."""

    def rows_of(what):
        below = folder / what
        is_entity = next(below.iterdir()).name.isdigit()
        for entity in [below] if is_entity else sorted(below.iterdir()):
            found = (json.loads((moment / "0/data.json").read_text())
                     for moment in moments_of(entity))
            yield entity.name, [(one["time_ns"], plain_value(one["data"])) for one in found]

    truth = truth_of(rows_of)
    times, files = [], []
    for moment in moments_of(folder / CAMERA):
        stamp = int(moment.name) * 1000
        if not times or stamp - times[0] == len(times) * IMAGE_PERIOD:
            times.append(stamp)
            files.append((moment / "0/image.png").read_bytes())
    done = subprocess.run(["ffmpeg", "-v", "error", "-f", "image2pipe", "-c:v", "png", "-i", "-",
                           "-f", "rawvideo", "-pix_fmt", "rgb24", "-"], input=b"".join(files),
                          capture_output=True)
    if done.returncode != 0:
        raise Failed(f"ffmpeg: {done.stderr.decode(errors='replace')[-300:]}")
    truth["image_times"] = times
    return truth, np.frombuffer(done.stdout, np.uint8).reshape(len(times), SIDE, SIDE, 3)


def verify_truth(engram, plan, day, truth, work):
    """Simulates a day again, into plain files. Raises Failed unless they say the same."""
    folder = work / f"plain-{day}"
    try:
        run(engram, "simulate", "kitchen", "--folder", folder, "--plain", *plan.options(day))
        (recording,) = folder.iterdir()
        plain, images = plain_truth(recording)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    for what, found in plain.items():
        if found != truth[what]:
            raise Failed(f"day {day}: the truth of '{what}' is not what the simulator writes")
    if not np.array_equal(images, truth["images"]):
        raise Failed(f"day {day}: the images are not those that the simulator writes")
