#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Puts questions to a store by the queries that every program has, in a process of its own.

It gets the questions without their answers. An answer that the store does not have is null.
"""
import argparse
import datetime
import json
import pathlib
import sys

import numpy as np

import days

EXAMPLES = """Example, with the package engram on PYTHONPATH:
  answer.py robot.engram questions.json truth answers.json
"""
RECENT = 60 * days.SECOND  # Longer ago is another recording, in which other objects may be there.


def text_of(when):
    """A time as queries have it. Unit of `when`: ns since 1970, in whole us."""
    moment = datetime.datetime.fromtimestamp(when // days.SECOND, datetime.timezone.utc)
    return f"{moment:%Y-%m-%dT%H:%M:%S}.{when % days.SECOND // 1000:06}Z"


class Answers:
    """Answers questions from a memory of the package engram.

    Threading: one thread.
    """

    def __init__(self, memory, images):
        """`images` gives a recorded image by the number of its day and its own number."""
        self.memory, self.images = memory, images
        self.actions = self.rows(f"{days.ACTIONS} @ all")
        self.speech = self.rows(f"{days.SPEECH} @ all")
        self.objects = {}

    def query(self, text):
        try:
            return self.memory.query(text)
        except LookupError:  # All of the entity was forgotten.
            return {}

    def rows(self, text):
        """(time, value) of all snapshots that a query finds, the oldest first."""
        found = [(one.time, one.value) for each in self.query(text).values() for one in each]
        return sorted(found, key=lambda row: row[0])

    def before(self, entity, when):
        """The last (time, value) of an entity at or before a moment."""
        return next(iter(self.rows(f"{entity} @ at-or-before:{text_of(when)}")), (None, None))[1]

    def answer(self, question):
        return getattr(self, f"{question['kind']}_{question['ask']}")(question)

    def where_object(self, question):
        value = self.before(f"{days.OBJECTS}/{question['object']}_1", question["time"])
        return value and [float(x) for x in value["pose_world_object"]["position"]]

    def where_robot(self, question):
        value = self.before(days.PLATFORM, question["time"])
        return value and [float(x) for x in value["pose_world_platform"][:2]]

    def last_success(self, skill, question):
        ended = [int(value["ended"]) for when, value in self.actions
                 if days.skill_of(value) == skill and value["outcome"] == 1 and when <= question["time"]
                 and days.name_of(value["object_before"]) == question["object"]]
        return max(ended, default=None)

    def when_picked(self, question):
        return self.last_success("pick", question)

    def when_placed(self, question):
        return self.last_success("place", question)

    def when_said(self, question):
        return max((when for when, value in self.speech
                    if value["text"] == question["words"] and when <= question["time"]),
                   default=None)

    def when_seen(self, question):
        """A view lasts until the next snapshot that tells otherwise, if that follows soon."""
        name = question["object"]
        if name not in self.objects:
            self.objects[name] = self.rows(f"{days.OBJECTS}/{name}_1 @ all")
        last = None
        for when, value in self.objects[name]:
            if when > question["time"]:
                break
            if value["is_visible"]:
                last, is_open = when, True
            elif last is not None and is_open:
                is_open = False
                if when - last < RECENT:
                    last = max(last, when - days.STATE_PERIOD)
        return last

    def what_image(self, question):
        """The candidate that differs least, by squares, from the image of the nearest moment."""
        found = self.rows(f"{days.CAMERA} @ nearest:{text_of(question['time'])}~1d")
        if not found:
            return None
        seen = np.asarray(self.image_of(found[0][1]), np.float32)
        errors = [float(((np.asarray(self.images(*each), np.float32) - seen) ** 2).mean())
                  for each in question["candidates"]]
        return int(np.argmin(errors))

    @staticmethod
    def image_of(value):
        return value["image"]

    def what_held(self, question):
        found = [(when, name) for name, each in
                 self.query(f"{days.OBJECTS} @ at-or-before:{text_of(question['time'])}").items()
                 for when, value in ((one.time, one.value) for one in each)
                 if value["held_by"] and question["time"] - when < RECENT]
        return max(found)[1].rsplit("/", 1)[1].removesuffix("_1") if found else None

    def what_doing(self, question):
        begun = [(int(value["started"]), value) for when, value in self.actions
                 if when <= question["time"]]
        if not begun:
            return None
        value = max(begun, key=lambda one: one[0])[1]
        return [days.skill_of(value), days.name_of(value["object_before"])]

    def what_said(self, question):
        said = [value["text"] for when, value in self.speech if when <= question["time"]]
        return said[-1] if said else None


def main():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("store", help="the store")
    parser.add_argument("questions", type=pathlib.Path, help="JSON file")
    parser.add_argument("truth", type=pathlib.Path, help="folder of recorded images to choose from")
    parser.add_argument("answers", type=pathlib.Path, help="JSON file to write")
    options = parser.parse_args()
    import engram

    recorded = [np.load(options.truth / f"{day}.npy", mmap_mode="r")
                for day in range(len(list(options.truth.glob("*.npy"))))]
    questions = json.loads(options.questions.read_text())
    answers = {}
    with engram.open(options.store) as memory:
        asked = Answers(memory, lambda day, image: recorded[day][image])
        for question in sorted(questions, key=lambda one: one["time"]):  # Blocks are decoded once.
            answers[question["number"]] = asked.answer(question)
    options.answers.write_text(json.dumps([answers[one["number"]] for one in questions]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
