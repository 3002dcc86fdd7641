#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Is a replay the memory that it was?

A recording is lived again: its snapshots are committed to a live memory with a store, in their
order, and between them questions are asked at random moments. What the memory answered, byte by
byte, is kept. Then the store is replayed: at each of these moments, in random order, the same
question must give the same bytes. Predictions are asked in the order in which they were asked
then, since they depend a little on what was asked before.

Each answer is also looked through for anything that arrived after its moment, with its links: a
leak. Then the time of a seek is measured, with the state of every entity after it, and the order
in which a watch is told at 1 and at 10 times the speed.
"""
import argparse
import json
import os
import pathlib
import pickle
import random
import shutil
import subprocess
import sys
import time

EXAMPLES = """Examples:
  replay_bars.py build/release/bin/engram build/release/python
  replay_bars.py build/release/bin/engram build/release/python --store robot.engram
  replay_bars.py build/release/bin/engram build/release/python --only-seek ten_million.engram
"""
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
    kind = draw.choice(("whole", "past", "near", "ids"))
    if kind == "whole":
        return draw.choice((".*/.*/.*/.* @ latest", entity.split("/")[0] + " @ latest"))
    if kind == "ids":
        return f"?ids {entity} @ all"
    if kind == "past":
        return f"{entity} @ {draw.choice(PAST)}"
    moment = draw.randrange(span[0], span[1])
    return f"{entity} @ {draw.choice(('nearest', 'before', 'after', 'until', 'at-or-before'))}:{moment}"


def live(engram, source, store, moments, with_images, draw):
    """Lives a recording again. Returns what was asked, what was committed and how it arrived."""
    steps = snapshots_of(engram, source, not with_images)
    entities = sorted({name for _, name, _ in steps})
    number_of = [name for name in entities if "joints" in name or "platform" in name] or entities
    begin = time.time_ns()
    asked, ahead, came = [], [], []
    due = sorted(draw.randrange(len(steps)) for _ in range(moments))
    due_ahead = set(range(len(steps) // 4, len(steps), max(len(steps) // 100, 1)))
    with engram.open(store, read_only=False, working_bytes=1 << 20) as memory:
        next_one = 0
        for i, (_, name, value) in enumerate(steps):
            memory.commit(name, value, time.time_ns(), durability="memory")
            came.append(name)
            while next_one < len(due) and due[next_one] == i:
                query = question(draw, entities, (begin, time.time_ns() + 10**9))
                at = time.time_ns()
                asked.append((at, query, ask(memory, query, engram.EngramError)))
                next_one += 1
            if i in due_ahead:
                query = f"{draw.choice(number_of)} @ +200ms"
                ahead.append((time.time_ns(), query, ask(memory, query, engram.EngramError)))
    return asked, ahead, came


def times_in(answer):
    for name, snapshots in answer.items():
        for one in () if name.startswith(REPLAY) else snapshots:
            if one.source != "predicted":
                yield one.time


def compare(engram, store, asked, ahead, draw):
    order = list(range(len(asked)))
    draw.shuffle(order)
    equal = leaks = 0
    seeks = []
    with engram.replay(store, paused=True) as memory:
        for i in order:
            at, query, answer = asked[i]
            begin = time.perf_counter()
            memory.replaying.seek(at)
            seeks.append(time.perf_counter() - begin)
            equal += ask(memory, query, engram.EngramError) == answer
            try:
                leaks += sum(told > at for told in times_in(memory.query(query)))
            except engram.EngramError:
                pass
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
        report |= {"snapshots": len(came), "moments": len(asked), "equal": equal, "leaks": leaks,
                   "predictions": len(ahead), "equal_predictions": predicted,
                   "seek_ms": percentiles([1e3 * one for one in seeks])}
        told = {speed: order_at(engram, store, speed, len(came)) for speed in (1, 10)}
        report["orders_equal"] = told[1] == told[10] and [name for name, _ in told[1]] == came
        report["told"] = len(told[1])
        print(f"{len(came)} snapshots lived; {equal} of {len(asked)} answers have the same bytes, "
              f"{leaks} leaks; {predicted} of {len(ahead)} predictions are equal")
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
