#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What do a tenth of the snapshots of kitchens still answer, if the most salient ones are kept?

Kitchens of seeds that nothing was chosen by are recorded into one store. A copy of it forgets all
but a tenth of its snapshots by saliency, with `engram forget`. Then 1,000 questions are asked, by
queries, that were made from the full store without any knowledge of saliency (questions.py).

Beside it, with as many snapshots: every tenth snapshot of each entity ("uniform"); the newest tenth
of the store ("newest"); and as many snapshots of each entity, evenly in time, so that entities with few
are kept whole ("even"). With --history there is another copy whose weights were learned from what
was asked before ("learned"). The score is the share of right answers; the full store has all of them
right, or the run fails.
"""
import argparse
import datetime
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import questions as asking
import recorded

NEEDED = 0.9
RIVALS = ["uniform", "newest", "even"]
FORGET = "forget:\n  rules: [{{saliency: {{keep: {share}}}}}]\n  protect: {{newest: 0}}\n"


def run(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words[:3]))} ended with {done.returncode}: "
                 f"{done.stderr[-800:]}")
    return done.stdout


def tell(text):
    print(text, file=sys.stderr, flush=True)


def times_of(memory):
    """The times of all snapshots, by entity."""
    return {entity.name: entity.times().astype("int64").tolist() for entity in memory}


def uniform(times, share):
    """Every so-manieth snapshot of each entity, the first one included."""
    step = round(1 / share)
    return {name: set(found[::step]) for name, found in times.items()}


def newest(times, share):
    """The newest of all snapshots."""
    every = sorted((when for found in times.values() for when in found), reverse=True)
    limit = every[int(share * len(every)) - 1]
    return {name: {when for when in found if when >= limit} for name, found in times.items()}


def even(times, share):
    """As many of each entity, evenly in time; those with fewer are kept whole."""
    budget = int(share * sum(len(found) for found in times.values()))
    kept, left = {}, len(times)
    for name, found in sorted(times.items(), key=lambda one: len(one[1])):
        count = min(len(found), budget // left)
        kept[name] = {found[i * len(found) // count] for i in range(count)}
        budget, left = budget - count, left - 1
    return kept


def forget(options, full, small):
    """A copy of the full store that forgets by saliency."""
    shutil.rmtree(small, ignore_errors=True)
    shutil.copytree(full, small)
    config = options.work / "forget.yaml"
    config.write_text(FORGET.format(share=options.share))
    run(options.engram, "forget", small, "--config", config, "--yes", "--json")


def read_history(options, full, store, asked):
    """A copy of the full store of which some moments were asked for, and that learned from it."""
    shutil.rmtree(store, ignore_errors=True)
    shutil.copytree(full, store)
    for question in asked:
        moment = datetime.datetime.fromtimestamp(question["time"] // 10**9, datetime.timezone.utc)
        when = f"{moment:%Y-%m-%dT%H:%M:%S}.{question['time'] % 10**9:09}Z"
        run(options.engram, "query", store, f"{asking.OBJECTS}{question['object']}_1 "
            f"@ at-or-before:{when}")
    run(options.engram, "why-salient", store, asking.SPEECH, "--keep", "--json")
    told = json.loads(run(options.engram, "why-salient", store, asking.SPEECH, "--json"))
    return {"learned_from": told["learned_from"],
            "weights": {one["part"]: one["weight"] for one in told["parts"]}}


def measure(options):
    import engram

    full, small = options.work / "full.engram", options.work / "salient.engram"
    if not full.exists():
        tell(f"simulates kitchens {options.seeds}")
        run(options.engram, "simulate", "kitchen", full, "--fast", "--seed", options.seeds,
            "--seconds", options.seconds)
    started = time.monotonic()
    tell("calculates the saliency")
    run(options.engram, "why-salient", full, asking.SPEECH, "--keep", "--json")
    forget(options, full, small)
    took = time.monotonic() - started
    with engram.open(full) as memory:
        times = times_of(memory)
        answerers = {"full": asking.Kitchens(memory)}
        for rival in RIVALS:
            answerers[rival] = asking.Kitchens(memory, globals()[rival](times, options.share))
    with engram.open(small) as memory:
        kept = times_of(memory)
        answerers["salient"] = asking.Kitchens(memory)
    asked = asking.Maker(answerers["full"], options.seed).make(options.questions)
    learned = None
    if options.history:
        tell("asks where carried objects were, and learns from it")
        before = asking.Maker(answerers["full"], options.seed + 1)
        history = options.work / "history.engram"
        learned = read_history(options, full, history, [
            before.question("carried") for _ in range(options.history)])
        forget(options, history, options.work / "learned.engram")
        with engram.open(options.work / "learned.engram") as memory:
            answerers["learned"] = asking.Kitchens(memory)
    right = {name: [asking.is_right(one, who.answer(one)) for one in asked]
             for name, who in answerers.items()}
    if not all(right["full"]):
        sys.exit("saliency_bars: the full store does not answer all questions, so they are wrong")
    kinds = sorted({one["kind"] for one in asked})
    snapshots = sum(len(found) for found in times.values())
    result = {
        "seeds": options.seeds, "questions": len(asked), "snapshots": snapshots,
        "kept": sum(len(found) for found in kept.values()), "seconds": took, "stores": {},
        "by_entity": {name: [len(kept.get(name, [])), len(found)]
                      for name, found in times.items()}}
    for name in sorted(set(answerers) - {"full"}, key=["salient", "learned", *RIVALS].index):
        by_kind = {kind: [ok for one, ok in zip(asked, right[name]) if one["kind"] == kind]
                   for kind in kinds}
        result["stores"][name] = {"all": sum(right[name]) / len(asked),
                                  **{kind: sum(ok) / len(ok) for kind, ok in by_kind.items()}}
    if learned:
        result["learned"] = learned
    if options.recordings:
        tell("looks at recordings")
        rivals = {name: globals()[name] for name in RIVALS}
        result["recordings"] = recorded.measure(options, engram, rivals, forget, times_of)
    result["asked"] = {kind: sum(one["kind"] == kind for one in asked) for kind in kinds}
    return result


def show(result):
    """Whether the bar is reached."""
    print(f"kitchens {result['seeds']}: {result['kept']:,} of {result['snapshots']:,} snapshots "
          f"are kept, {result['questions']:,} questions\n")
    names = list(result["stores"])
    print(f"| questions | number | {' | '.join(names)} |\n|---|---|{'---|' * len(names)}")
    for kind, number in result["asked"].items():
        print(f"| {kind} | {number} | " + " | ".join(
            f"{100 * result['stores'][name][kind]:.1f} %" for name in names) + " |")
    print(f"| **all** | {result['questions']} | " + " | ".join(
        f"{100 * result['stores'][name]['all']:.1f} %" for name in names) + " |")
    print("\n| snapshots of | kept | of |\n|---|---|---|")
    groups = {}
    for name, (kept, count) in result["by_entity"].items():
        sums = groups.setdefault("/".join(name.split("/")[:2]), [0, 0])
        sums[0] += kept
        sums[1] += count
    for name, (kept, count) in sorted(groups.items(), key=lambda one: -one[1][1]):
        print(f"| {name} | {kept:,} | {count:,} |")
    if "learned" in result:
        print(f"\nweights learned from {result['learned']['learned_from']} reads: " + ", ".join(
            f"{part} {weight:.2f}" for part, weight in result["learned"]["weights"].items()))
    if "recordings" in result:
        recorded.show(result["recordings"])
    score = result["stores"]["salient"]["all"]
    is_reached = score >= NEEDED
    print(f"\n{'reached' if is_reached else 'MISSED'}: {100 * score:.1f} %, needs "
          f"{100 * NEEDED:.0f} %")
    return is_reached


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", type=pathlib.Path, help="the program")
    parser.add_argument("package", type=pathlib.Path, help="the folder of the package engram")
    parser.add_argument("--seeds", default="401..406", help="kitchens (401..406)")
    parser.add_argument("--seconds", default="60", help="length of a recording (60)")
    parser.add_argument("--questions", type=int, default=1000, help="number of questions (1000)")
    parser.add_argument("--seed", type=int, default=11, help="same seed, same questions (11)")
    parser.add_argument("--share", type=float, default=0.1, help="what is kept (0.1)")
    parser.add_argument("--history", type=int, default=0, metavar="N",
                        help="also learn weights from N other questions about carried objects (0)")
    parser.add_argument("--work", type=pathlib.Path, help="folder that keeps stores for later calls")
    parser.add_argument("--recordings", type=pathlib.Path, help="also look at recordings of g1")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    options = parser.parse_args()
    if not options.engram.exists():
        parser.error(f"{options.engram}: no such program")
    if not 0 < options.share <= 1 or options.questions < 1:
        parser.error("needs a share of more than 0 and 1 at most, and a question or more")
    sys.path.insert(0, str(options.package))
    with tempfile.TemporaryDirectory(prefix="saliency_bars-") as folder:
        options.work = options.work or pathlib.Path(folder)
        options.work.mkdir(parents=True, exist_ok=True)
        result = measure(options)
    if options.json:
        options.json.write_text(json.dumps(result, indent=1))
    return 0 if show(result) else 1


if __name__ == "__main__":
    sys.exit(main())
