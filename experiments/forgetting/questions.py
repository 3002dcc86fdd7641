# SPDX-License-Identifier: Apache-2.0
"""Questions about where, when and what, made from the truth of days by a seed.

A question is a dict: `ask` says what is asked, `time` the moment T of which it asks, `moment` when
that happened what the answer tells (its age counts), `day` the number of that day, `truth` the
right answer. Days are drawn evenly, and kinds in turn.

    kind   ask      the question                                            a right answer
    where  object   Where was X at T?                                       within 5 cm
           robot    Where was the robot at T?                               within 5 cm
    when   picked   When was X last picked up before T?                     within 2 s
           placed   When was X last put down before T?                      within 2 s
           said     When did somebody last say W before T?                  within 2 s
           seen     When was X last seen before T, as it is hidden now?     within 0.5 s
    what   image    Which of 16 recorded images is what was seen at T?      that one
           held     What was held at T?                                     the object
           doing    What was done at T, and with what?                      both
           said     What was said last before T?                            these words
"""
import bisect
import random

import days

ASKS = {"where": ["object", "robot"], "when": ["picked", "placed", "said", "seen"],
        "what": ["image", "image", "held", "doing", "said"]}
SUCCESS = 1
SAME_DAY, CHOICES = 7, 16  # Wrong images of the same day and so of the same room; all images.
MIN_APART = days.SECOND  # Between the right image and others of its day. Unit: ns.


class Events:
    """What happened when, by what is asked of it: (time, day) in the order of time."""

    def __init__(self, truths):
        self.found = {}
        for day, truth in enumerate(truths):
            for action in truth["actions"]:
                if action["outcome"] == SUCCESS and action["skill"] in ("pick", "place"):
                    self.add({"pick": "picked", "place": "placed"}[action["skill"]],
                             action["object"], action["ended"], day)
            for said in truth["speech"]:
                self.add("said", said["text"], said["time"], day)
            for name, rows in truth["objects"].items():
                self.add_views(name, rows, day)

    def add(self, ask, what, when, day):
        self.found.setdefault((ask, what), []).append((when, day))

    def add_views(self, name, rows, day):
        """An object is asked for from its last view to its next one."""
        for row, after in zip(rows, rows[1:] + [None]):
            if row["is_visible"] and after and not after["is_visible"]:
                self.add("seen", name, row["time"], day)
            elif row["is_visible"]:
                self.add("in sight", name, row["time"], day)

    def of_day(self, ask, day):
        return sorted((when, what) for (kind, what), moments in self.found.items() if kind == ask
                      for when, where in moments if where == day)

    def next_after(self, ask, what, when, end):
        """When that happens again; an object that is seen again is not asked for any more."""
        kinds = ("seen", "in sight") if ask == "seen" else (ask,)
        later = [moment for kind in kinds for moment, _ in self.found.get((kind, what), [])
                 if moment > when]
        return min(later, default=end)


class Maker:
    """Makes questions. Those of one seed are always the same."""

    def __init__(self, truths, seed):
        self.truths, self.random = truths, random.Random(seed)
        self.events = Events(truths)
        self.end = max(truths[-1]["image_times"][-1], truths[-1]["platform"][-1]["time"])

    def make(self, count):
        """As many of each kind, each with its number."""
        made = []
        while len(made) < count:
            kind = list(ASKS)[len(made) % len(ASKS)]
            day = self.random.randrange(len(self.truths))
            ask = self.random.choice(ASKS[kind])
            question = getattr(self, f"{kind}_{ask}" if kind != "when" else "when")(day, ask)
            if question:  # Else nothing of that sort happened on that day.
                made.append({"number": len(made), "kind": kind, "ask": ask, "day": day, **question})
        return made

    def moment_within(self, begin, end):
        """A time in whole ms, since nobody asks in nanoseconds."""
        ms = 1_000_000
        first, last = begin // ms + 1, (end - 1) // ms
        return self.random.randint(first, last) * ms if last >= first else None

    def moment_of(self, day):
        platform = self.truths[day]["platform"]
        return self.moment_within(platform[0]["time"], platform[-1]["time"])

    @staticmethod
    def last_before(rows, when):
        return rows[bisect.bisect_right([row["time"] for row in rows], when) - 1]

    def where_object(self, day, _):
        name = self.random.choice(sorted(self.truths[day]["objects"]))
        when = self.moment_of(day)
        rows = self.truths[day]["objects"][name]
        return {"object": name, "time": when, "moment": when,
                "truth": self.last_before(rows, when)["position"]}

    def where_robot(self, day, _):
        when = self.moment_of(day)
        rows = self.truths[day]["platform"]
        before, after = self.last_before(rows, when), None
        after = next((row for row in rows if row["time"] > when), before)
        span = max(after["time"] - before["time"], 1)
        share = (when - before["time"]) / span
        return {"time": when, "moment": when,
                "truth": [a + share * (b - a)
                          for a, b in zip(before["position"], after["position"])]}

    def when(self, day, ask):
        found = self.events.of_day(ask, day)
        if not found:
            return None
        when, what = self.random.choice(found)
        asked = self.moment_within(when + days.STATE_PERIOD,
                                   self.events.next_after(ask, what, when, self.end))
        return asked and {"words" if ask == "said" else "object": what, "time": asked,
                          "moment": when, "truth": when}

    def what_image(self, day, _):
        """The candidates are in an order of chance. Each is the number of a day and of an image."""
        times = self.truths[day]["image_times"]
        right = self.random.randrange(len(times))
        others = [(day, i) for i, when in enumerate(times) if abs(when - times[right]) >= MIN_APART]
        elsewhere = [(other, i) for other in range(len(self.truths)) if other != day
                     for i in range(len(self.truths[other]["image_times"]))]
        wrong = self.random.sample(others, SAME_DAY)
        wrong += self.random.sample(elsewhere, CHOICES - 1 - SAME_DAY)
        candidates = wrong + [(day, right)]
        self.random.shuffle(candidates)
        return {"time": times[right], "moment": times[right], "candidates": candidates,
                "truth": candidates.index((day, right))}

    def what_held(self, day, _):
        found = [(row["time"], after["time"], name)
                 for name, rows in self.truths[day]["objects"].items()
                 for row, after in zip(rows, rows[1:]) if row["held_by"] and after["held_by"]]
        if not found:
            return None
        begin, end, name = self.random.choice(sorted(found))
        when = self.moment_within(begin, end)
        return when and {"time": when, "moment": when, "truth": name}

    def what_doing(self, day, _):
        done = [action for action in self.truths[day]["actions"] if action["ended"]]
        if not done:
            return None
        action = self.random.choice(done)
        when = self.moment_within(action["started"], action["ended"])
        return when and {"time": when, "moment": when,
                         "truth": [action["skill"], action["object"]]}

    def what_said(self, day, _):
        speech = self.truths[day]["speech"]
        when = self.moment_of(day)
        said = [one for one in speech if one["time"] <= when]
        if not said:
            return None
        return {"time": when, "moment": said[-1]["time"], "truth": said[-1]["text"]}
