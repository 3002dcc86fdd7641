#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How many of the faults in a kitchen does `engram reflect` find, and how often is it wrong?

Kitchens of several seeds are simulated. First each is looked at as it is: whatever is found there
is a false alarm. Their rate is the share of looks that found anything; a look is one kind of
finding that was looked for in one entity. Then faults are put into copies, each at a place of its
own: no two of one entity within five seconds. A fault is found if there is a finding of its kind,
of its entity, whose time overlaps that of the fault, give or take a quarter of a second.
"""
import argparse
import collections
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

EXAMPLES = """Examples:
  reflection_bars.py build/release/bin/engram build/release/python
  reflection_bars.py build/release/bin/engram build/release/python --faults 46 --seeds 3,4
  reflection_bars.py build/release/bin/engram build/release/python --hour
"""
NEAR = 250_000_000


def seeds_of(text):
    found = []
    for part in text.split(","):
        first, _, last = part.partition("..")
        found += range(int(first), int(last or first) + 1)
    return found


def reflect(engram, store, *options):
    begin = time.perf_counter()
    done = subprocess.run([engram, "reflect", store, "--json", *options], check=True,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    return json.loads(done.stdout), time.perf_counter() - begin


def simulate(engram, folder, seeds):
    missing = [seed for seed in seeds if not (folder / f"kitchen-{seed}.engram").exists()]
    if missing:
        subprocess.run([engram, "simulate", "kitchen", "--folder", folder, "--fast", "--progress",
                        "none", "--seed", ",".join(map(str, missing))], check=True,
                       stdout=subprocess.DEVNULL)
    return [folder / f"kitchen-{seed}.engram" for seed in seeds]


def look_at_clean(engram, stores):
    looks, alarms, told = 0, 0, collections.Counter()
    for store in stores:
        report, _ = reflect(engram, store, "--images")
        looks += report["looks"]
        wrong = {(one["entity"], one["kind"]) for one in report["findings"]}
        alarms += len(wrong)
        told.update(kind for _, kind in wrong)
        for one in report["findings"]:
            print(f"  {store.name}: {one['kind']} {one['entity']} {one['member']} {one['first']}: "
                  f"{one['found']}", file=sys.stderr)
    return {"kitchens": len(stores), "looks": looks, "false_alarms": alarms, "by_kind": dict(told)}


def is_found(fault, findings):
    return any(one["entity"] == fault.entity and one["kind"] in fault.wanted
               and one["first_ns"] <= fault.last + NEAR and fault.first - NEAR <= one["last_ns"]
               for one in findings)


def is_explained(finding, all_faults):
    """Whether a fault of any entity lies at the time of a finding: faults have consequences."""
    return any(finding["first_ns"] <= fault.last + 2 * NEAR
               and fault.first - 2 * NEAR <= finding["last_ns"] for fault in all_faults)


def inject(kitchen, rng, kinds, per_kitchen):
    import faults

    places = faults.Places()
    made = []
    # A clock that is shifted would hide under other faults of its entity.
    for kind in sorted(kinds[:per_kitchen], key=lambda one: one is not faults.shifted_clock):
        for _ in range(8):
            fault = kind(kitchen, places, rng)
            if fault is not None:
                made.append(fault)
                break
        else:
            print(f"  no place for: {kind.__name__}", file=sys.stderr)
    return made


def look_at_faults(arguments, stores, work):
    import faults
    import kitchens
    import numpy as np

    rng = np.random.default_rng(arguments.seed)
    wanted, number, copies = arguments.faults, 0, 0
    found, all_of, missed, unexplained = collections.Counter(), collections.Counter(), [], 0
    while sum(all_of.values()) < wanted:
        kitchen = kitchens.Kitchen(stores[copies % len(stores)])
        left = min(arguments.per_kitchen, wanted - sum(all_of.values()))
        kinds = [faults.KINDS[(number + k) % len(faults.KINDS)] for k in range(left)]
        number += left
        made = inject(kitchen, rng, kinds, left)
        copy = work / f"faulty-{copies}.engram"
        shutil.rmtree(copy, ignore_errors=True)
        kitchen.write(copy)
        report, _ = reflect(arguments.engram, copy, "--images")
        for fault in made:
            all_of[fault.kind] += 1
            if is_found(fault, report["findings"]):
                found[fault.kind] += 1
            else:
                missed.append({"copy": copy.name, "kind": fault.kind, "entity": fault.entity,
                               "first": str(np.datetime64(fault.first, "ns")),
                               "last": str(np.datetime64(fault.last, "ns"))})
        for one in report["findings"]:
            if not is_explained(one, made):
                unexplained += 1
                print(f"  {copy.name}: without a fault: {one['kind']} {one['entity']} "
                      f"{one['member']} {one['first']}: {one['found']}", file=sys.stderr)
        copies += 1
        if not arguments.keep:
            shutil.rmtree(copy)
    return {"faults": sum(all_of.values()), "found": sum(found.values()), "copies": copies,
            "by_kind": {kind: [found[kind], count] for kind, count in sorted(all_of.items())},
            "findings_without_fault": unexplained, "missed": missed}


def look_at_hour(engram, stores, work):
    """The time that an hour takes: sixty recordings of a minute, one after the other."""
    import kitchens

    store = work / "hour.engram"
    if not store.exists():
        kitchens.write_one_after_the_other(stores, 60, store)
    _, first = reflect(engram, store)
    report, second = reflect(engram, store)
    return {"snapshots": report["snapshots"], "seconds": min(first, second),
            "findings": len(report["findings"]), "looks": report["looks"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", help="the program")
    parser.add_argument("python", help="the folder of the package")
    parser.add_argument("--seeds", default="111..116", help="of the kitchens")
    parser.add_argument("--kitchens", type=pathlib.Path, help="folder of recordings to use")
    parser.add_argument("--faults", type=int, default=200)
    parser.add_argument("--per-kitchen", type=int, default=8, help="faults in one copy")
    parser.add_argument("--seed", type=int, default=77, help="of the faults' places")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("build/reflection"))
    parser.add_argument("--keep", action="store_true", help="keep the copies with faults")
    parser.add_argument("--hour", action="store_true", help="also the time that an hour takes")
    parser.add_argument("--json", type=pathlib.Path, help="file for the figures")
    arguments = parser.parse_args()
    sys.path.insert(0, arguments.python)
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    import kitchens

    kitchens.kitchen_types.engram = arguments.engram
    arguments.work.mkdir(parents=True, exist_ok=True)
    folder = arguments.kitchens or arguments.work / "kitchens"
    stores = simulate(arguments.engram, folder, seeds_of(arguments.seeds))
    figures = {"seeds": arguments.seeds, "clean": look_at_clean(arguments.engram, stores)}
    clean = figures["clean"]
    print(f"clean: {clean['false_alarms']} of {clean['looks']} looks are false alarms "
          f"({100 * clean['false_alarms'] / clean['looks']:.2f} %; bar: max 2 %)")
    figures["faulty"] = look_at_faults(arguments, stores, arguments.work)
    faulty = figures["faulty"]
    for kind, (found, count) in faulty["by_kind"].items():
        print(f"  {kind:22} {found:3} of {count:3}")
    print(f"faults: {faulty['found']} of {faulty['faults']} found "
          f"({100 * faulty['found'] / faulty['faults']:.1f} %; bar: min 95 %), "
          f"{faulty['findings_without_fault']} findings at times without a fault")
    for missed in faulty["missed"]:
        print(f"  missed: {missed}", file=sys.stderr)
    if arguments.hour:
        figures["hour"] = look_at_hour(arguments.engram, stores, arguments.work)
        hour = figures["hour"]
        print(f"an hour: {hour['snapshots']} snapshots in {hour['seconds']:.1f} s (bar: 10 s)")
    if arguments.json:
        arguments.json.write_text(json.dumps(figures, indent=2) + "\n")


if __name__ == "__main__":
    main()
