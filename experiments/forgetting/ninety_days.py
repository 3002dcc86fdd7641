#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Does a store that fades answer what the full one answers, with a tenth of its bytes?

Ninety days of the simulated kitchen are recorded into one store, which is consolidated and
compacted: the full store. Two copies of it forget until they take a tenth of its bytes. One fades
and forgets by forgetting.yaml, the other deletes the oldest. Then each store is asked the same
1,000 questions about where, when and what, by a process of its own. The score of a small store is
the share that it answers rightly of what the full store answers rightly. Beside them are a store
that forgot everything, the best constant answers, chosen with the truth, and chance.
"""
import argparse
import datetime
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import days
import questions as asking
import scores

FOLDER = pathlib.Path(__file__).resolve().parent
CONSOLIDATION = ["--representation", "video", "--drop-raw", "--progress", "none", "--json"]
# Without "newest: 0" a model of each entity stays, and that is more than a small quota.
OLDEST = "forget:\n  quota: {{max_bytes: {bytes}B}}\n  protect: {{newest: 0}}\n"
EMPTY = "forget:\n  rules: [{older_than: 0s}]\n  protect: {newest: 0}\n"
SMALL = ["fading", "oldest", "empty", "constant", "chance"]
NEEDED = 0.9

EXAMPLES = """Examples:
  ninety_days.py build/release/bin/engram
  ninety_days.py build/release/bin/engram --days 6 --questions 100 --share 0.5
  ninety_days.py build/release/bin/engram --work build/ninety_days --config mine.yaml

Ages count back from --today, and the program forgets by the clock: leave --today out unless
recordings of an earlier call are in --work.
"""


def bytes_of(store):
    """Bytes of all files below a folder."""
    return sum(file.stat().st_size for file in store.rglob("*") if file.is_file())


def entity_bytes(engram, store):
    """Bytes of entities by the first two levels of their names, of models, and of the rest."""
    found = {}
    for one in json.loads(days.run(engram, "info", store, "--json"))["entities"]:
        name = "/".join(one["id"].split("/")[:2])
        found[name] = found.get(name, 0) + one["stored_bytes"] + one["latent_bytes"]
    for model in (store / "models").iterdir():
        found["models"] = found.get("models", 0) + model.stat().st_size
    found["everything else"] = bytes_of(store) - sum(found.values())
    return found


def made_whole(path, make):
    """Makes a file or folder unless it is there. One that was half made is not taken for whole."""
    if path.exists():
        return
    part = path.with_name(path.name + ".part")
    if part.is_dir():
        shutil.rmtree(part)
    part.unlink(missing_ok=True)
    make(part)
    part.rename(path)


def make_full(options, recorded, full):
    """The recordings, consolidated as well as Engram can without further loss, and compacted."""
    shutil.copytree(recorded, full)
    days.tell("consolidates all days")
    days.run(options.engram, "consolidate", full, *CONSOLIDATION, "--steps", options.steps,
             "--min-snapshots", options.min_snapshots)
    days.run(options.engram, "compact", full)


def forget(options, full, store, config, quota):
    """Makes a copy of the full store forget until it is within a quota."""
    shutil.rmtree(store, ignore_errors=True)
    shutil.copytree(full, store)
    file = options.work / f"{store.stem}.yaml"
    file.write_text(config)
    start = time.monotonic()
    days.run(options.engram, "forget", store, "--config", file, "--yes", "--json")
    days.run(options.engram, "compact", store)
    found = bytes_of(store)
    if found > quota:
        raise days.Failed(f"{store.name} takes {found:,} bytes, its quota is {quota:,}")
    return time.monotonic() - start


def ask(options, store, asked, truth):
    """The answers of a store, by a process of its own that does not know what is right."""
    days.tell(f"asks {store.name} {len(asked)} questions")
    with tempfile.TemporaryDirectory(dir=options.work) as folder:
        put, got = pathlib.Path(folder) / "questions.json", pathlib.Path(folder) / "answers.json"
        put.write_text(json.dumps([{key: value for key, value in one.items()
                                    if key not in ("truth", "moment")} for one in asked]))
        environment = dict(os.environ, PYTHONPATH=str(options.package))
        done = subprocess.run([sys.executable, "-B", FOLDER / "answer.py", store, put, truth, got],
                              env=environment, capture_output=True, text=True)
        if done.returncode != 0:
            raise days.Failed(f"answer.py {store.name}: {done.stderr[-800:]}")
        return json.loads(got.read_text())


def measure(options):
    plan = days.Plan(options.days, options.seed, options.seconds, options.today)
    recorded, full, truth = (options.work / name for name in
                             ("recorded.engram", "full.engram", "truth"))
    sys.path.insert(0, str(options.package))
    import engram as package

    made_whole(recorded, lambda part: days.record(options.engram, plan, part, options.work))
    made_whole(truth, lambda part: days.write_truth(package, plan, recorded, part))
    truths = days.read_truth(truth)
    for number in range(options.verify):
        day = number * (plan.days - 1) // max(options.verify - 1, 1)
        days.verify_truth(options.engram, plan, day, truths[day], options.work)
        days.tell(f"day {day}: the simulator writes the same again")
    made_whole(full, lambda part: make_full(options, recorded, part))
    quota = int(bytes_of(full) * options.share)
    result = {"days": plan.days, "seed": plan.seed, "today": str(plan.today),
              "quota_bytes": quota, "recorded_bytes": bytes_of(recorded), "stores": {}}
    fading = re.sub(r"max_bytes: \w+", f"max_bytes: {quota}B", options.config.read_text())
    asked = asking.Maker(truths, options.seed).make(options.questions)
    configs = {"full": None, "fading": fading, "oldest": OLDEST.format(bytes=quota),
               "empty": EMPTY}
    answered = {}
    for name, config in configs.items():
        store = options.work / f"{name}.engram"
        took = forget(options, full, store, config, quota) if config else None
        answered[name] = scores.rights(asked, ask(options, store, asked, truth))
        result["stores"][name] = {"bytes": bytes_of(store), "forgetting_seconds": took,
                                  "by_entity": entity_bytes(options.engram, store)}
    answered["constant"] = scores.constant_rights(asked)
    answered["chance"] = scores.chance_rights(asked)
    for name, right in answered.items():
        result["stores"].setdefault(name, {"bytes": 0})
        result["stores"][name] |= {
            "right": sum(right) / len(right),
            "table": scores.table_of(asked, answered["full"], right, plan.now),
            "by_ask": scores.by_ask(asked, answered["full"], right)}
    return result


def percent(number):
    return "-" if number is None else f"{100 * number:.1f} %"


def show(result):
    """Whether the bar is reached."""
    stores = result["stores"]
    print(f"{result['days']} days, seed {result['seed']}; recorded without loss "
          f"{result['recorded_bytes']:,} bytes; the quota is {result['quota_bytes']:,} bytes\n")
    print("| store | bytes | right of all | of what the full one answers |\n|---|---|---|---|")
    for name, one in stores.items():
        print(f"| {name} | {one['bytes']:,} | {percent(one['right'])} | "
              f"{percent(one['table']['all, all']['share'])} |")
    for title, key in (("kind, age of the moment", "table"), ("question", "by_ask")):
        print(f"\n| {title} | right of the full store | {' | '.join(SMALL)} |\n"
              f"|---|---{'|---' * len(SMALL)}|")
        for row, found in stores["full"][key].items():
            print(f"| {row} | {found['full']} | "
                  f"{' | '.join(percent(stores[name][key][row]['share']) for name in SMALL)} |")
    print("\n| bytes of | full | fading | oldest |\n|---|---|---|---|")
    for name, found in sorted(stores["full"]["by_entity"].items(), key=lambda one: -one[1]):
        print(f"| {name} | {found:,} | " + " | ".join(
            f"{stores[small]['by_entity'].get(name, 0):,}" for small in SMALL[:2]) + " |")
    score = stores["fading"]["table"]["all, all"]["share"] or 0
    is_reached = score >= NEEDED
    print(f"\n{'reached' if is_reached else 'MISSED'}: {percent(score)} of what the full store "
          f"answers, needs {percent(NEEDED)}; deleting the oldest: "
          f"{percent(stores['oldest']['table']['all, all']['share'])}")
    return is_reached


def arguments_of(words=None):
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", type=pathlib.Path, help="the program, with its package beside it")
    parser.add_argument("--days", type=int, default=90, help="days that are simulated (90)")
    parser.add_argument("--seconds", type=float, default=12, help="length of a day (12)")
    parser.add_argument("--questions", type=int, default=1000, help="number of questions (1000)")
    parser.add_argument("--seed", type=int, default=7,
                        help="same seed, same days and questions (7)")
    parser.add_argument("--share", type=float, default=0.1,
                        help="quota, of the full store's bytes (0.1)")
    parser.add_argument("--steps", type=int, default=500,
                        help="training of each network of the full store (500)")
    parser.add_argument("--min-snapshots", type=int, default=1000, help="entities with fewer stay "
                        "as recorded: their networks would take more bytes (1000)")
    parser.add_argument("--config", type=pathlib.Path, default=FOLDER / "forgetting.yaml",
                        help="what is forgotten; its max_bytes is replaced (forgetting.yaml)")
    parser.add_argument("--verify", type=int, default=2, help="days that are simulated twice, to "
                        "see that the truth is the simulator's (2)")
    parser.add_argument("--today", type=datetime.date.fromisoformat, metavar="DATE",
                        default=datetime.datetime.now(datetime.timezone.utc).date(),
                        help="the day after the last one (today)")
    parser.add_argument("--work", type=pathlib.Path, help="folder that keeps stores, with which a "
                        "later call goes on; else a temporary one")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    options = parser.parse_args(words)
    if not options.engram.exists():
        parser.error(f"{options.engram}: no such program")
    if options.days < 3 or options.seconds < 8 or options.questions < 1:
        parser.error("needs 3 days, 8 seconds and a question, or more")
    if not 0 < options.share <= 1:
        parser.error(f"--share: found {options.share}, needs more than 0 and 1 at most")
    options.package = options.engram.resolve().parents[1] / "python"
    return options


def main():
    options = arguments_of()
    try:
        with tempfile.TemporaryDirectory(prefix="ninety_days-") as folder:
            options.work = options.work or pathlib.Path(folder)
            options.work.mkdir(parents=True, exist_ok=True)
            result = measure(options)
    except days.Failed as failed:
        sys.exit(f"ninety_days: {failed}")
    except KeyboardInterrupt:
        sys.exit(130)
    if options.json:
        options.json.write_text(json.dumps(result, indent=1))
    return 0 if show(result) else 1


if __name__ == "__main__":
    sys.exit(main())
