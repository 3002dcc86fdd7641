# SPDX-License-Identifier: Apache-2.0
"""What happens on each day of a month, and how its raw data are made.

`engram simulate kitchen` draws each room once, as one long recording at 20 Hz with small images,
and a day takes the next images of its left camera. They count as 5 Hz: the robot moves at a quarter
of its speed, because what a camera on a head sees changes so much in 200 ms that hardly anything
can be learned from one image about the next.

The program cannot draw the same room in other light or from elsewhere. So the images are changed
after they were drawn, always in the same way: light is a gain for each night and a warmer or colder
balance of colours; the camera sees a window of what was drawn, and where it was moved another and a
smaller one, enlarged. Some noise, as a camera has it, is different in each image.
"""
from __future__ import annotations

import math
import pathlib
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

CAMERA = "Vision/RGB/head/cam"
JOINTS = "RobotState/Proprioception/robot/joints"
DRAWN_HZ = 20
HZ = 5
STEP_NS = 10**9 // HZ
DAY_NS = 24 * 3600 * 10**9
FIRST_DAY_NS = int(np.datetime64("2026-01-01T10:00").astype("datetime64[ns]").astype(np.int64))
NIGHT_AFTER_NS = 12 * 3600 * 10**9  # From the begin of a day to its night.
DRAWN_SIDE = 128
NOISE_GREY_LEVELS = 0.5
LONG_DAY = 10
# An event-driven day repeats this: so many images in which the robot moves, and so many without.
MOVING_IMAGES, RESTING_IMAGES = 10, 20


@dataclass(frozen=True)
class Plan:
    """The days of a month: numbers of days (from 1) by what happens on them."""

    nights: int
    images: int  #: Of a usual day.
    side: int  #: Of an image. Unit: pixels.
    rooms: dict[int, int]  #: Seed of the kitchen by the first day in it.
    moved: int  #: The camera stands elsewhere from this day on.
    calm: int
    events: int
    killed: int
    short: int
    full: int
    long: int
    early: int  #: The nights whose costs are compared.
    late: int
    bytes_from: int  #: From this night on bytes are compared.
    steps: int  #: Of training.
    kill_after: float  #: From the begin of work on images to the kill. Unit: s.
    short_seconds: float  #: What the short night has.
    #: What the three nights after the short one have, in usual nights; 0: as long as they like.
    catching_up: float

    def room_of(self, day: int) -> int:
        """The first day in the room of a day."""
        return max(first for first in self.rooms if first <= day)

    def images_of(self, day: int) -> int:
        return self.images * (LONG_DAY if day == self.long else 1)

    def changes_until(self, day: int) -> int:
        """How often the scene has changed: other rooms, and the camera."""
        return sum(first <= day for first in self.rooms) - 1 + (self.moved <= day)

    def happenings(self, day: int) -> list[str]:
        """What is unusual about a day and its night, in words."""
        told = {"a new room": day in self.rooms and day > 1, "camera moved": day == self.moved,
                "calm": day == self.calm, "event-driven": day == self.events,
                f"{LONG_DAY} times as long": day == self.long, "killed": day == self.killed,
                "far too short": day == self.short, "full disk": day == self.full}
        return [name for name, is_so in told.items() if is_so]

    def is_usual(self, day: int) -> bool:
        """Whether neither the day nor its night is unusual in a way that changes what it costs."""
        return not {*self.happenings(day)} - {"a new room", "camera moved"}


PLANS = {
    "full": Plan(nights=30, images=300, side=112, rooms={1: 1, 10: 2, 20: 3}, moved=15, calm=4,
                 events=7, killed=12, short=17, full=22, long=25, early=5, late=30, bytes_from=10,
                 steps=300, kill_after=5, short_seconds=6, catching_up=1.5),
    "short": Plan(nights=11, images=40, side=64, rooms={1: 1, 4: 2, 8: 3}, moved=6, calm=2,
                  events=3, killed=5, short=7, full=9, long=10, early=4, late=11, bytes_from=5,
                  steps=30, kill_after=0.2, short_seconds=1, catching_up=0),
    "test": Plan(nights=9, images=20, side=64, rooms={1: 1, 5: 2}, moved=7, calm=3, events=5,
                 killed=2, short=4, full=6, long=8, early=1, late=9, bytes_from=5, steps=10,
                 kill_after=0.05, short_seconds=0.2, catching_up=0)}


@dataclass
class RawDay:
    """What the sensors gave on one day. Moments are STEP_NS apart.

    Shape: images [N, side, side, 3], joints [N, J], times [N].
    """

    times: npt.NDArray[np.int64]
    images: npt.NDArray[np.uint8]
    joints: npt.NDArray[np.float32]
    places: dict[int, int] = field(init=False)  #: Row by time.

    def __post_init__(self) -> None:
        self.places = {int(time): row for row, time in enumerate(self.times)}

    def save(self, file: pathlib.Path) -> None:
        part = file.with_suffix(".part.npz")
        np.savez(part, times=self.times, images=self.images, joints=self.joints)
        part.rename(file)

    @staticmethod
    def load(file: pathlib.Path) -> RawDay:
        with np.load(file) as found:
            return RawDay(found["times"], found["images"], found["joints"])


def begin_of(day: int) -> int:
    """When a day begins. Unit: ns."""
    return FIRST_DAY_NS + (day - 1) * DAY_NS


def file_of(folder: pathlib.Path, day: int) -> pathlib.Path:
    return folder / f"day-{day:02}.npz"


def day_of(time: int) -> int:
    return (time - FIRST_DAY_NS) // DAY_NS + 1


def drawn_rows(plan: Plan, day: int) -> npt.NDArray[np.int64]:
    """Which drawn images of its room a day shows, one for each of its moments."""
    count = plan.images_of(day)
    first = sum(plan.images_of(other) for other in range(plan.room_of(day), day))
    if day == plan.calm:
        return np.full(count, first)
    if day == plan.events:
        both = MOVING_IMAGES + RESTING_IMAGES
        ticks = np.arange(count * both // MOVING_IMAGES)
        moved = ticks // both * MOVING_IMAGES + np.minimum(ticks % both, MOVING_IMAGES - 1)
        return np.asarray(first + moved, np.int64)
    return first + np.arange(count)


def drawn_seconds(plan: Plan, room: int) -> float:
    """How long a room has to be simulated."""
    days = [day for day in range(room, plan.nights + 1) if plan.room_of(day) == room]
    return (max(int(drawn_rows(plan, day).max()) for day in days) + 2) / DRAWN_HZ


def light_of(day: int) -> npt.NDArray[np.float64]:
    """By what red, green and blue are multiplied."""
    gain = 0.9 + 0.1 * math.cos(2 * math.pi * day / 11)
    warmth = 0.05 * math.sin(2 * math.pi * day / 7)
    return gain * np.array([1 + warmth, 1, 1 - warmth])


def seen(plan: Plan, day: int, drawn: npt.NDArray[np.uint8]) -> npt.NDArray[np.float64]:
    """The window of a drawn image that the camera sees."""
    side = plan.side
    if day < plan.moved:
        first = (DRAWN_SIDE - side) // 2
        return drawn[first : first + side, first : first + side].astype(np.float64)
    # Six sevenths of the side, further up and to the right, enlarged.
    small = side * 6 // 7
    top, left = (DRAWN_SIDE - small) // 4, (DRAWN_SIDE - small) * 3 // 4
    window = drawn[top : top + small, left : left + small].astype(np.float64)
    return enlarged(enlarged(window, side, 0), side, 1)


def enlarged(image: npt.NDArray[np.float64], size: int, axis: int) -> npt.NDArray[np.float64]:
    """Linear interpolation along one axis."""
    places = np.linspace(0, image.shape[axis] - 1, size)
    low = np.minimum(places.astype(int), image.shape[axis] - 2)
    share = (places - low).reshape([-1 if one == axis else 1 for one in range(image.ndim)])
    return np.asarray(image.take(low, axis) * (1 - share) + image.take(low + 1, axis) * share)


def photographed(plan: Plan, day: int, row: int, drawn: npt.NDArray[np.uint8],
                 ) -> npt.NDArray[np.uint8]:
    """What the camera makes of a drawn image as moment `row` of a day."""
    noise = np.random.default_rng([day, row]).normal(0, NOISE_GREY_LEVELS,
                                                     (plan.side, plan.side, 3))
    return np.rint(seen(plan, day, drawn) * light_of(day) + noise).clip(0, 255).astype(np.uint8)


def make_days(plan: Plan, room: int, folder: pathlib.Path, draw: Callable[..., None]) -> None:
    """Makes the raw data of all days in the room that begins with day `room`.

    `draw(store, seed, seconds)` records the kitchen.
    """
    import engram

    days = [day for day in range(room, plan.nights + 1) if plan.room_of(day) == room]
    if all(file_of(folder, day).exists() for day in days):
        return
    store = folder / f"room-{room}.engram"
    shutil.rmtree(store, ignore_errors=True)
    draw(store, plan.rooms[room], drawn_seconds(plan, room))
    with engram.open(store) as kitchen:
        views, body = kitchen["Vision/RGB/head/stereo"], kitchen[JOINTS]
        moments = views.times().astype(np.int64)
        for day in days:
            rows = drawn_rows(plan, day)
            first, last = int(moments[rows.min()]), int(moments[rows.max()])
            images = [one.image.copy() for one in views.snapshots(first, last)]
            joints = {one.time: one.value["positions"] for one in body.snapshots(first, last)}
            RawDay(begin_of(day) + STEP_NS * np.arange(len(rows), dtype=np.int64),
                   np.stack([photographed(plan, day, at, images[row - rows.min()])
                             for at, row in enumerate(rows)]),
                   np.stack([joints[int(moments[row])] for row in rows]).astype(np.float32),
                   ).save(file_of(folder, day))
    shutil.rmtree(store)
