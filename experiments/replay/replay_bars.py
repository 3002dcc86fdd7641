#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Is a replay the memory that it was?

A recording is lived again: its snapshots are committed to a live memory with a store, in their
order, and between them questions are asked at random moments. Each snapshot is measured some time
before it is committed, those of some entities out of order; their links lead to what was lived.
What the memory answered, byte by byte, is kept. Then the store is replayed: at each of these
moments, in random order, the same question must give the same bytes. Predictions are asked in the
order in which they were asked then, since they depend a little on what was asked before.

Each answer is also looked through for anything that arrived after its moment: a leak. So is what
its links lead to, and what links to an entity, asked at the same moment. Then the time of a seek is measured, with the state of every entity after it, and the order
in which a watch is told at 1 and at 10 times the speed.
"""
import argparse
import json
import os
import pathlib
import pickle
import random
import re
import shutil
import subprocess
import sys
import time

EXAMPLES = """Examples:
  replay_bars.py build/release/bin/engram build/release/python
  replay_bars.py build/release/bin/engram build/release/python --store robot.engram
  replay_bars.py build/release/bin/engram build/release/python --only-seek ten_million.engram
"""
STEP_NS = 2 * 10**6  # Between two commits.
MAX_LATE_NS = 50 * 10**6
LINKS = 5  # Of each answer so many are followed.
PAST = ("latest", "latest:3", "-4..-2", "0..3", "last:300ms", "all")
REPLAY = "SystemState"


def bytes_of(answer):
    """An answer as bytes: everything that it tells, without what a replay says of itself."""
    def plain(value):
        if hasattr(value, "tobytes"):
            return ("array", str(value.dtype), value.shape, value.tobytes())
        if isinstance(value, dict):
            return [(key, plain(one)) for key, one in value.items()]
        if isinstance(value, (list, tuple)):
            return [plain(one) for one in value]
        return repr(value)

    def told(snapshot):
        return [snapshot.time, snapshot.source, snapshot.model, snapshot.predictor,
                [[plain(one.value), repr(one.error), repr(one.bound), repr(one.members)]
                 for one in snapshot.instances]]

    return pickle.dumps([(name, [told(one) for one in snapshots])
                         for name, snapshots in answer.items() if not name.startswith(REPLAY)])


def ask(memory, query, errors):
    try:
        return bytes_of(memory.query(query))
    except errors as error:
        return type(error).__name__.encode()


def snapshots_of(engram, store, small):
    """All snapshots in the order of time: entity, time and value."""
    found = []
    with engram.open(store) as memory:
        for entity in memory:
            if small and entity.name.startswith("Vision/"):
                continue
            found += [(one.time, entity.name, one.value) for one in entity.snapshots()]
    return sorted(found, key=lambda one: one[:2])


def question(draw, entities, span):
    entity = draw.choice(entities)
    kind = draw.choice(("whole", "past", "near", "ids", "linked"))
    if kind == "whole":
        return draw.choice((".*/.*/.*/.* @ latest", entity.split("/")[0] + " @ latest"))
    if kind == "ids":
        return f"?ids {entity} @ all"
    if kind == "past":
        return f"{entity} @ {draw.choice(PAST)}"
    if kind == "linked":
        how = draw.choice(("linked-to", "links-from", "not linked-to"))
        return f"{entity} @ latest:3 {how} {draw.choice(entities)}"
    moment = draw.randrange(span[0], span[1])
    return f"{entity} @ {draw.choice(('nearest', 'before', 'after', 'until', 'at-or-before'))}:{moment}"


def number_entities(entities):
    """Those whose predictions are compared."""
    return [name for name in entities if "joints" in name or "platform" in name] or entities


def times_of(steps, entities, begin, draw):
    """When each snapshot is measured, if one is committed each STEP_NS from `begin` on.

    Those of half of the entities come out of order, except where predictions are compared: what
    engines learned depends on what came when they were asked.
    """
    late = {name: draw.choice((0, MAX_LATE_NS // 5, None)) for name in entities}
    late |= {name: MAX_LATE_NS // 5 for name in number_entities(entities)}
    times = {}
    taken = set()
    for i, (old, name, _) in enumerate(steps):
        by = late[name] if late[name] is not None else draw.randrange(MAX_LATE_NS)
        time_ns = begin + i * STEP_NS - by
        while (name, time_ns) in taken:
            time_ns += 1
        taken.add((name, time_ns))
        times[name, old] = time_ns
    return times


def link_of(engram, text):
    """Entity and time of a text that reads as the ID of a snapshot, and what follows them."""
    from engram.times import to_ns  # pylint: disable=import-outside-toplevel
    names = re.split(r"(?<!\\)/", text)
    if len(names) not in (5, 6):
        return None
    try:
        moment = int(names[4]) if names[4].isdigit() else to_ns(names[4])
        return "/".join(names[:4]), moment, names[5:]
    except (engram.EngramError, ValueError):
        return None


def relinked(engram, value, times):
    """A value whose links lead to what was lived."""
    if isinstance(value, dict):
        return {key: relinked(engram, one, times) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [relinked(engram, one, times) for one in value]
    link = link_of(engram, value) if isinstance(value, str) else None
    if link is None or link[:2] not in times:
        return value
    return "/".join([link[0], str(times[link[:2]]), *link[2]])


def links_in(engram, value):
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, (list, tuple)):
        for one in value:
            yield from links_in(engram, one)
    elif isinstance(value, str) and (link := link_of(engram, value)):
        yield link[:2]


def live(engram, source, store, moments, with_images, draw):
    """Lives a recording again. Returns what was asked, and what was committed in its order."""
    steps = snapshots_of(engram, source, not with_images)
    entities = sorted({name for _, name, _ in steps})
    number_of = number_entities(entities)
    asked, ahead, came = [], [], []
    due = sorted(draw.randrange(len(steps)) for _ in range(moments))
    due_ahead = set(range(len(steps) // 4, len(steps), max(len(steps) // 100, 1)))
    begin = time.time_ns() + MAX_LATE_NS
    times = times_of(steps, entities, begin, draw)
    with engram.open(store, read_only=False, working_bytes=1 << 20) as memory:
        next_one = 0
        for i, (old, name, value) in enumerate(steps):
            time.sleep(max(begin + i * STEP_NS - time.time_ns(), 0) / 1e9)
            memory.commit(name, relinked(engram, value, times), times[name, old],
                          durability="memory")
            came.append((name, times[name, old]))
            while next_one < len(due) and due[next_one] == i:
                query = question(draw, entities, (begin, time.time_ns() + 10**9))
                at = time.time_ns()
                asked.append((at, query, ask(memory, query, engram.EngramError)))
                next_one += 1
            if i in due_ahead:
                query = f"{draw.choice(number_of)} @ +200ms"
                ahead.append((time.time_ns(), query, ask(memory, query, engram.EngramError)))
    return asked, ahead, came


def arrivals_of(engram, store):
    """When each snapshot of a store arrived."""
    with engram.open(store) as memory:
        return {(entity.name, one.time): max(instance.arrived for instance in one.instances)
                for entity in memory for one in entity.snapshots()}


class Leaks:
    """Counts what a replay tells at a moment although it arrived later."""

    def __init__(self, engram, arrivals):
        self.engram, self.arrivals = engram, arrivals
        self.found = self.looked = self.linked = self.late = 0

    def look(self, memory, query, at):
        links = self._look_through(self._ask(memory, query), at)
        for name, entity, moment in links[:LINKS]:
            self.linked += 1
            self.late += self.arrivals.get((entity, moment), 0) > at
            for linked in (f"{entity} @ time:{moment}", f"{entity} @ all links-from {name}",
                           f"{name} @ all linked-to {entity}/{moment}"):
                self._look_through(self._ask(memory, linked), at)

    def _ask(self, memory, query):
        try:
            return memory.query(query)
        except self.engram.EngramError:
            return {}

    def _look_through(self, answer, at):
        links = []
        for name, snapshots in answer.items():
            for one in () if name.startswith(REPLAY) else snapshots:
                if one.source == "predicted":
                    continue
                self.looked += 1
                self.found += self.arrivals[name, one.time] > at
                for instance in one.instances:
                    links += [(name, *link) for link in links_in(self.engram, instance.value)]
        return links


def compare(engram, store, asked, ahead, draw):
    order = list(range(len(asked)))
    draw.shuffle(order)
    equal = 0
    leaks = Leaks(engram, arrivals_of(engram, store))
    seeks = []
    with engram.replay(store, paused=True) as memory:
        for i in order:
            at, query, answer = asked[i]
            begin = time.perf_counter()
            memory.replaying.seek(at)
            seeks.append(time.perf_counter() - begin)
            equal += ask(memory, query, engram.EngramError) == answer
            leaks.look(memory, query, at)
    with engram.replay(store, paused=True) as memory:
        predicted = 0
        for at, query, answer in ahead:
            memory.replaying.seek(at)
            predicted += ask(memory, query, engram.EngramError) == answer
    return equal, leaks, predicted, seeks


def order_at(engram, store, speed, count):
    """What a watch is told, until it was told of `count` snapshots or of none for 20 s."""
    told = []
    with engram.replay(store, paused=True) as memory:
        with memory.watch(data=False, queue=10**6) as watch:
            memory.replaying.set_speed(speed)
            memory.replaying.play()
            last = time.monotonic()
            while len(told) < count and time.monotonic() - last < 20:
                event = watch.next(1)
                if event is None or event.entity.startswith(REPLAY):
                    continue
                told.append((event.entity, event.time))
                last = time.monotonic()
    return told


def seek_times(engram, store, seeks, draw):
    """Seeks at random, and the state of every entity after it. Unit: ms."""
    jump, state = [], []
    begin = time.perf_counter()
    with engram.replay(store, paused=True) as memory:
        opened = time.perf_counter() - begin
        span = memory.replaying.state
        begin = time.perf_counter()
        memory.replaying.seek(span.last)
        memory.query(".* @ latest")
        warm = time.perf_counter() - begin
        entities = [name for name in memory.entities if not name.startswith(REPLAY)]
        for _ in range(seeks):
            begin = time.perf_counter()
            memory.replaying.seek(draw.randrange(span.first + 10**9, span.last))
            jump.append(1e3 * (time.perf_counter() - begin))
            begin = time.perf_counter()
            answer = memory.query(".* @ latest")
            state.append(1e3 * (time.perf_counter() - begin))
            assert all(answer[name] for name in answer)
    return {"open_s": opened, "first_s": warm, "entities": len(entities),
            "seek_ms": percentiles(jump), "state_ms": percentiles(state)}


def percentiles(numbers):
    numbers = sorted(numbers)
    return {"median": numbers[len(numbers) // 2], "p99": numbers[int(0.99 * len(numbers))],
            "max": numbers[-1]}


def ms(numbers):
    return "median {median:.1f}, p99 {p99:.1f}, max {max:.1f} ms".format(**numbers)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", type=pathlib.Path)
    parser.add_argument("python", help="folder of the package")
    parser.add_argument("--store", type=pathlib.Path, help="recording; else a kitchen is simulated")
    parser.add_argument("--only-seek", type=pathlib.Path, help="store in which seeks are measured")
    parser.add_argument("--moments", type=int, default=1000)
    parser.add_argument("--images", action="store_true", help="live the images of Vision, too")
    parser.add_argument("--seconds", type=int, default=30, help="length of the kitchen")
    parser.add_argument("--folder", type=pathlib.Path, default=pathlib.Path("build/replay_bars"))
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    sys.path.insert(0, arguments.python)
    import engram  # pylint: disable=import-outside-toplevel

    draw = random.Random(1)
    arguments.folder.mkdir(parents=True, exist_ok=True)
    report = {"cores": os.cpu_count()}
    if arguments.only_seek is None:
        source = arguments.store or arguments.folder / "kitchen.engram"
        if not source.exists():
            subprocess.run([arguments.engram, "simulate", "kitchen", source, "--fast", "--seconds",
                            str(arguments.seconds), "--progress", "none"], check=True,
                           stdout=subprocess.DEVNULL)
        store = arguments.folder / "lived.engram"
        shutil.rmtree(store, ignore_errors=True)
        asked, ahead, came = live(engram, source, store, arguments.moments, arguments.images,
                                  draw)
        equal, leaks, predicted, seeks = compare(engram, store, asked, ahead, draw)
        report |= {"snapshots": len(came), "moments": len(asked), "equal": equal,
                   "leaks": leaks.found, "looked_through": leaks.looked,
                   "followed_links": leaks.linked, "links_to_later": leaks.late,
                   "predictions": len(ahead), "equal_predictions": predicted,
                   "seek_ms": percentiles([1e3 * one for one in seeks])}
        told = {speed: order_at(engram, store, speed, len(came)) for speed in (1, 10)}
        report["orders_equal"] = told[1] == told[10] and told[1] == came
        report["told"] = len(told[1])
        print(f"{len(came)} snapshots lived; {equal} of {len(asked)} answers have the same bytes, "
              f"{predicted} of {len(ahead)} predictions are equal")
        print(f"{leaks.found} leaks in {leaks.looked} snapshots that were told; {leaks.linked} links "
              f"followed, {leaks.late} of them to what arrived later")
        print(f"seek: {ms(report['seek_ms'])}; order at 10 times the speed equal: "
              f"{report['orders_equal']} ({len(told[1])} and {len(told[10])} told)")
        report["state"] = seek_times(engram, source, 50, draw)
        print(f"recording with {report['state']['entities']} entities: state of all after a seek: "
              f"{ms(report['state']['state_ms'])}")
    else:
        report["seek"] = seek_times(engram, arguments.only_seek, 200, draw)
        print(f"{arguments.only_seek}: opened in {report['seek']['open_s']:.2f} s, first state "
              f"{report['seek']['first_s']:.2f} s; seek {ms(report['seek']['seek_ms'])}; state of "
              f"{report['seek']['entities']} entities {ms(report['seek']['state_ms'])}")
    if arguments.json:
        arguments.json.write_text(json.dumps(report, indent=1))


if __name__ == "__main__":
    main()
