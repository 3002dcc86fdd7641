# SPDX-License-Identifier: Apache-2.0
"""Questions about recorded kitchens, made from the full store by a seed, and who answers them.

They are made without any knowledge of what is salient. A question is a dict: `kind` says what is
asked, `time` the moment T of which it asks, `truth` the right answer.

    kind     question                                     a right answer
    robot    Where was the robot at T?                    within 5 cm
    object   Where was X at T?                            within 5 cm
    carried  Where was X at T, while somebody held it?    within 5 cm
    failed   What failed or was stopped last before T?    skill, object and outcome
    doing    What did the robot do at T, and with what?   skill and object
    said     What was said last before T?                 the words
"""
import bisect
import random

import numpy as np

PLATFORM = "RobotState/Localization/robot/platform"
OBJECTS = "Objects/Instances/kitchen/"
ACTIONS = "Skill/Event/robot/"
SPEECH = "Speech/Commands/human/text"
MAX_METRES = 0.05
FAILURES = {2: "failure", 3: "stop"}
# A quarter asks each: where things were, what failed, what the robot did, what was said.
TURNS = ["robot", "failed", "doing", "said", "object", "failed", "doing", "said",
         "carried", "failed", "doing", "said"]


def name_of(link):
    """The name of the entity behind a link: "salt" of ".../salt_1/TIME/0"; "" of none."""
    return link.split("/")[3].removesuffix("_1") if link else ""


def rows_of(memory, entity):
    """(time in ns, value) of all snapshots, the oldest first; none where all were forgotten."""
    try:
        answer = memory.query(f"{entity} @ all")
    except LookupError:
        return []
    found = [(one.time, one.value) for snapshots in answer.values() for one in snapshots]
    return sorted(found, key=lambda row: row[0])


class Kitchens:
    """What a store knows of where things were, what was done and what was said.

    `kept`, if it is given, says by entity and time whether a snapshot is there.
    """

    def __init__(self, memory, kept=None):
        def rows(entity):
            return [row for row in rows_of(memory, entity)
                    if kept is None or row[0] in kept.get(entity, ())]

        names = sorted(entity.name for entity in memory)
        self.platform = [(when, [float(x) for x in value["pose_world_platform"][:2]])
                         for when, value in rows(PLATFORM)]
        self.objects, self.held = {}, {}
        for name in names:
            if not name.startswith(OBJECTS):
                continue
            short = name.removeprefix(OBJECTS).removesuffix("_1")
            found = rows(name)
            self.objects[short] = [(when, [float(x) for x in value["pose_world_object"]["position"]])
                                   for when, value in found]
            self.held[short] = [(when, value["held_by"]) for when, value in found]
        self.actions = []
        for name in names:
            if name.startswith(ACTIONS):
                self.actions += [(int(value["started"]), when, value["skill"].rpartition("/")[2],
                                  name_of(value.get("object_before")), int(value["outcome"]))
                                 for when, value in rows(name)]
        self.actions.sort()
        self.speech = [(when, value["text"]) for when, value in rows(SPEECH)]

    @staticmethod
    def before(rows, when):
        at = bisect.bisect_right([row[0] for row in rows], when) - 1
        return rows[at][1] if at >= 0 else None

    def robot(self, question):
        return self.before(self.platform, question["time"])

    def object(self, question):
        return self.before(self.objects[question["object"]], question["time"])

    carried = object

    def failed(self, question):
        found = [(when, skill, thing, FAILURES[outcome])
                 for _, when, skill, thing, outcome in self.actions
                 if outcome in FAILURES and when <= question["time"]]
        return list(max(found)[1:]) if found else None

    def doing(self, question):
        begun = [row for row in self.actions if row[0] <= question["time"]]
        return [begun[-1][2], begun[-1][3]] if begun else None

    def said(self, question):
        return self.before(self.speech, question["time"])

    def answer(self, question):
        return getattr(self, question["kind"])(question)


def is_right(question, answer):
    if answer is None:
        return False
    if question["kind"] in ("robot", "object", "carried"):
        return float(np.linalg.norm(np.subtract(answer, question["truth"]))) <= MAX_METRES
    return answer == question["truth"]


class Maker:
    """Makes questions from the full store. Those of one seed are always the same."""

    def __init__(self, full, seed):
        self.full, self.random = full, random.Random(seed)
        times = [when for when, _ in full.platform]
        cuts = [i for i in range(1, len(times)) if times[i] - times[i - 1] > 10**9]
        self.spans = [(times[a], times[b - 1]) for a, b in zip([0, *cuts], [*cuts, len(times)])]
        self.carries = [(name, when, after) for name, rows in full.held.items()
                        for (when, hand), (after, hand_after) in zip(rows, rows[1:])
                        if hand and hand == hand_after and after - when < 10**9]

    def moment(self):
        """A moment that is equally likely anywhere in the recordings."""
        first, last = self.random.choice(self.spans)  # All are equally long.
        return self.random.randint(first, last)

    def question(self, kind):
        """None if nothing of that kind is to be asked of the moment that was drawn."""
        made = {"kind": kind, "time": self.moment()}
        if kind == "object":
            made["object"] = self.random.choice(sorted(self.full.objects))
        if kind == "carried":
            made["object"], first, last = self.random.choice(self.carries)
            made["time"] = self.random.randint(first, last)
        span = next((one for one in self.spans if one[0] <= made["time"] <= one[1]), None)
        if kind == "object" and not any(span[0] <= when <= made["time"]
                                        for when, _ in self.full.objects[made["object"]]):
            return None  # It is not in this kitchen.
        if kind in ("doing", "said", "failed"):
            rows = {"doing": [row[0] for row in self.full.actions],
                    "said": [when for when, _ in self.full.speech],
                    "failed": [row[1] for row in self.full.actions if row[4] in FAILURES]}[kind]
            if not any(span[0] <= when <= made["time"] for when in rows):
                return None
        made["truth"] = self.full.answer(made)
        return made

    def make(self, count):
        made = []
        while len(made) < count:
            question = self.question(TURNS[len(made) % len(TURNS)])
            if question:
                made.append(question)
        return made
