#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How often does `engram ask` answer rightly, refuse rightly, and how soon?

Kitchens without images are simulated, of seeds that nothing was trained on. Questions with true
answers are made of each (docs/dialogues.md), asked of its store, and judged. The blind baseline
gives each form of question its commonest answer in the other kitchens.
"""
import argparse
import collections
import datetime
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import time

import judge

EXAMPLES = """Examples:
  ask_bars.py build/release/bin/engram build/experiments/ask/engram_make_dialogues
  ask_bars.py ENGRAM MAKE --seeds 5001..5004 --questions 200
  ask_bars.py ENGRAM MAKE --phrasings others.jsonl --questions 2000
  ask_bars.py ENGRAM MAKE --days 30 --questions 300

Kitchens are kept in the folder of --work and used again."""

FAMILIES = ["objects", "events", "explanations", "action_detail", "at_a_time", "problems",
            "what_if", "unanswerable"]


def seeds_of(text):
    found = []
    for part in text.split(","):
        first, _, last = part.partition("..")
        found += range(int(first), int(last or first) + 1)
    return found


def run(*words, **more):
    return subprocess.run([str(word) for word in words], check=True, text=True,
                          stdout=subprocess.PIPE, **more).stdout


def simulate(arguments):
    """A store of each seed; those that are there are taken as they are."""
    folder = arguments.work / f"coloured-kitchens-{arguments.seconds:g}s"
    folder.mkdir(parents=True, exist_ok=True)
    stores = {seed: folder / f"kitchen-{seed}.engram" for seed in arguments.seeds}
    # A store whose simulation was stopped has no mark beside it.
    missing = [seed for seed, store in stores.items() if not store.with_suffix(".done").exists()]
    for seed in missing:
        subprocess.run(["rm", "-rf", "--", str(stores[seed])], check=True)
    begin = time.perf_counter()
    if missing:
        run(arguments.engram, "simulate", "kitchen", "--folder", folder, "--no-images",
            "--colours", "--seconds", arguments.seconds, "--jobs", arguments.jobs, "--progress",
            "none", "--seed", ",".join(map(str, missing)))
        for seed in missing:
            stores[seed].with_suffix(".done").touch()
        took = time.perf_counter() - begin
        print(f"{len(missing)} kitchens of {arguments.seconds:g} s in {took:.0f} s: "
              f"{took / len(missing):.1f} s each with {arguments.jobs} processes", flush=True)
    return list(stores.values())


def start_of_day(day):
    return f"{datetime.date(2026, 3, 1) + datetime.timedelta(days=day)} 09:00:00"


def simulate_days(arguments):
    """One store with a kitchen on each day, all of other seeds."""
    store = arguments.work / f"coloured-days-{arguments.days}-{arguments.seconds:g}s.engram"
    if not store.with_suffix(".done").exists():
        subprocess.run(["rm", "-rf", "--", str(store)], check=True)
        for day in range(arguments.days):
            run(arguments.engram, "simulate", "kitchen", store, "--no-images", "--colours", "--seed",
                arguments.seeds[0] + day, "--seconds", arguments.seconds, "--progress", "none",
                "--start", start_of_day(day))
        store.with_suffix(".done").touch()
    return [store]


def make_dialogues(arguments, stores):
    """The questions about each store, and what became of the lines of --phrasings."""
    count = -(-arguments.questions // len(stores))
    # Of the words of others all that fit are made, and then chosen among the kitchens.
    words = (["--phrasings", arguments.phrasings] if arguments.phrasings
             else ["--written"] if arguments.written else ["--count", count])
    by_store = {}
    for number, store in enumerate(stores):
        lines = run(arguments.make_dialogues, store, "--seed", arguments.seed + number, "--split",
                    arguments.split, "--careless", arguments.careless, *words)
        by_store[store] = [json.loads(line) for line in lines.splitlines()]
    if arguments.written:
        return chosen_evenly(by_store, arguments.questions, arguments.seed), None
    if arguments.phrasings:
        chosen = chosen_evenly(by_store, arguments.questions, arguments.seed)
        return chosen, lines_asked(arguments.phrasings, by_store, chosen)
    # The last ones of some kitchens, where the count is no multiple.
    return trimmed(by_store, arguments.questions), None


def template_of(dialogue):
    """The name of its template, without that of the verb: "how_often#w3fa9c1d2"."""
    return re.match(r"[^#]*#\w+", dialogue["phrasing"]).group()


def chosen_evenly(by_store, count, seed):
    """Takes each template as often as every other one, as far as there are questions of it."""
    chance = random.Random(seed)
    by_template = collections.defaultdict(list)
    for store, dialogues in by_store.items():
        for one in dialogues:
            by_template[template_of(one)].append((store, one))
    queues = list(by_template.values())
    chance.shuffle(queues)
    for queue in queues:
        chance.shuffle(queue)
    chosen = {store: [] for store in by_store}
    while count > 0 and any(queues):
        for queue in filter(None, queues):
            if count > 0:
                store, one = queue.pop()
                chosen[store].append(one)
                count -= 1
    return chosen


def lines_asked(file, made, chosen):
    """How many lines of a file of phrasings were asked, and how many fit no kitchen."""
    lines = [json.loads(line) for line in file.read_text().splitlines() if line.strip()]
    # Equal lines with a form are one template.
    count = len({(one["form"], one["question"]) for one in lines if "form" in one})
    count += sum("form" not in one for one in lines)
    fitting, asked = ({template_of(one) for dialogues in by_store.values() for one in dialogues}
                      for by_store in (made, chosen))
    return {"lines": count, "asked": len(asked), "left_out": len(fitting - asked),
            "fit_nothing": count - len(fitting)}


def trimmed(by_store, count):
    too_many = sum(map(len, by_store.values())) - count
    for store in reversed(list(by_store)):
        if too_many > 0 and by_store[store]:
            by_store[store].pop()
            too_many -= 1
    return by_store


def ask_options(arguments):
    network = ["--attention", arguments.attention] if arguments.attention else []
    return ["--route", arguments.route, *network]


def ask(arguments, store, dialogues):
    """Asks each at its time, or at the last moment of the store where it has none."""
    # Several runs may share the kitchens.
    file = arguments.work / f"questions-{os.getpid()}.jsonl"
    asked = [{name: one[name] for name in ("question", "now") if name in one}
             for one in dialogues]
    file.write_text("".join(json.dumps(one) + "\n" for one in asked))
    try:
        lines = run(arguments.engram, "ask", store, "--questions", file, "--json",
                    *ask_options(arguments)).splitlines()
    finally:
        file.unlink()
    answers = [json.loads(line) for line in lines if line.strip()]
    if len(answers) != len(dialogues):
        sys.exit(f"{store}: {len(dialogues)} questions got {len(answers)} answers")
    return answers


def known_ids(arguments, store):
    """The IDs of all instances, which answers may show."""
    return set(json.loads(run(arguments.engram, "query", store, "?ids .* @ all", "--json"))["ids"])


def blind_answers(by_store):
    """The commonest answer to each form in the other kitchens, as an answer of `engram ask`; None
    where there is no other kitchen."""
    counts = collections.defaultdict(lambda: collections.defaultdict(collections.Counter))
    for store, dialogues in by_store.items():
        for one in dialogues:
            counts[one["form"]][store][json.dumps(one["value"])] += 1

    def blind(store, dialogue):
        if len(by_store) < 2:
            return None
        total = collections.Counter()
        for other, counter in counts[dialogue["form"]].items():
            if other != store:
                total.update(counter)
        return {"value": json.loads(max(total, key=total.get)) if total else {"kind": "unknown"}}

    return blind


def percentile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, round(share * (len(values) - 1)))] if values else None


def row_of(dialogue, answer, ids, blind):
    """Figures of one answer. What is said needs evidence that exists, and what is right must be
    shown by it."""
    shown = judge.shown(answer)
    row = {"dialogue": dialogue, "answer": answer,
           "right": judge.is_right(dialogue, answer), "refused": judge.is_refused(answer),
           "blind": None if blind is None else judge.is_right(dialogue, blind),
           "has_evidence": bool(shown) and shown <= ids,
           "knows_later": any(judge.is_later(one, dialogue["now"]) for one in shown & ids),
           "is_shown": judge.is_shown(dialogue, answer), "took_ms": answer.get("took_ms")}
    row["right_and_shown"] = bool(row["right"] and row["is_shown"] and row["has_evidence"])
    return row


def judged(arguments, by_store):
    blind = blind_answers(by_store)
    rows = []
    for store, dialogues in by_store.items():
        answers = ask(arguments, store, dialogues)
        ids = known_ids(arguments, store)
        rows += [row_of(dialogue, answer, ids, blind(store, dialogue))
                 for dialogue, answer in zip(dialogues, answers)]
    return rows


def hostile_text(line):
    one = json.loads(line)
    return one["question"] * one.get("repeat", 1)


def hostile(arguments, store):
    """How texts that are no questions to a robot are taken: one of `answered` is worth a look."""
    texts = [hostile_text(line) for line in arguments.hostile.read_text().splitlines() if line]
    answers = ask(arguments, store, [{"question": text} for text in texts])
    answered = [text[:80] for text, answer in zip(texts, answers) if not judge.is_refused(answer)]
    return {"texts": len(texts), "refused": len(texts) - len(answered), "answered": answered,
            "max_ms": max(answer.get("took_ms") or 0 for answer in answers)}


def share(rows, name):
    values = [row[name] for row in rows if row[name] is not None]
    return sum(values) / len(values) if values else None


def share_of_groups(rows, name):
    """Figures of the questions that are alike in a member of their dialogue."""
    groups = collections.defaultdict(list)
    for row in rows:
        groups[row["dialogue"][name]].append(row)
    return {group: {"questions": len(of), "right": share(of, "right"),
                    "refused": share(of, "refused"), "blind": share(of, "blind")}
            for group, of in sorted(groups.items())}


def summary(rows):
    answerable = [row for row in rows if row["dialogue"]["answerable"]]
    said = [row for row in rows if not row["refused"]]
    # What nothing shows, as that nothing happened, cannot be shown by an answer.
    provable = [row for row in answerable if row["is_shown"] is not None]
    took = [row["took_ms"] for row in rows if row["took_ms"] is not None]
    families = share_of_groups(rows, "family")
    held_out = {}
    for what in ("phrasing", "seed", "thing"):
        of = [row for row in answerable if what in row["dialogue"]["held_out"]]
        if of:
            held_out[what] = {"questions": len(of), "right": share(of, "right")}
    return {
        "questions": len(rows), "right": share(answerable, "right"),
        "blind": share(answerable, "blind"),
        "unanswerable_refused": share(
            [row for row in rows if not row["dialogue"]["answerable"]], "refused"),
        "said": len(said), "routes": share_of_routes(said),
        "said_with_evidence": share(said, "has_evidence"),
        "said_of_later": share(said, "knows_later"),
        "provable": len(provable), "right_and_shown": share(provable, "right_and_shown"),
        "right_that_are_shown": share([row for row in provable if row["right"]], "is_shown"),
        "p50_ms": percentile(took, 0.5), "p95_ms": percentile(took, 0.95),
        "families": {one: families[one] for one in FAMILIES if one in families},
        "forms": share_of_groups(rows, "form"), "held_out": held_out}


def share_of_routes(said):
    """What each route says, and how much of it is right."""
    routes = collections.defaultdict(list)
    for row in said:
        routes[row["answer"].get("route", "none")].append(row)
    return {route: {"said": len(of), "right": share(of, "right")} for route, of in routes.items()}


def percent(value):
    return "-" if value is None else f"{100 * value:.1f} %"


def print_summary(figures, bar):
    print(f"{'family':15} {'questions':>9} {'right':>8} {'refused':>8} {'blind':>8}")
    for family, one in figures["families"].items():
        print(f"{family:15} {one['questions']:9} {percent(one['right']):>8} "
              f"{percent(one['refused']):>8} {percent(one['blind']):>8}")
    for what, one in figures["held_out"].items():
        print(f"new {what + ':':11} {one['questions']:9} {percent(one['right']):>8}")
    for route, one in figures["routes"].items():
        print(f"said by {route + ':':15} {one['said']:6}, of these right "
              f"{percent(one['right'])}")
    rows = [("right, of what can be answered", percent(figures["right"]), f"{bar:g} %"),
            ("the same, blind", percent(figures["blind"]), "printed"),
            ("refused, of what cannot be", percent(figures["unanswerable_refused"]), "95 %"),
            ("right, and shown by evidence", percent(figures["right_and_shown"]), f"{bar:g} %"),
            ("of the right ones, those shown", percent(figures["right_that_are_shown"]), "printed"),
            ("said with evidence that exists", percent(figures["said_with_evidence"]), "100 %"),
            ("said by what came after `now`", percent(figures["said_of_later"]), "0 %")]
    for name, ms, max_ms in (("p50", figures["p50_ms"], 50), ("p95", figures["p95_ms"], 300)):
        rows.append((f"time to answer, {name}", "-" if ms is None else f"{ms:.1f} ms", f"{max_ms} ms"))
    print()
    for name, value, wanted in rows:
        print(f"{name:34} {value:>9}   bar {wanted}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", help="the program")
    parser.add_argument("make_dialogues", help="the program engram_make_dialogues")
    parser.add_argument("--seeds", type=seeds_of, default="5001..5040", help="of the kitchens")
    parser.add_argument("--seconds", type=float, default=60, help="length of each")
    parser.add_argument("--questions", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1, help="chooses the questions")
    parser.add_argument("--split", default="all", choices=["all", "train", "held-out"])
    parser.add_argument("--careless", type=float, default=0,
                        help="share of questions in small letters or with letters swapped")
    words = parser.add_mutually_exclusive_group()
    words.add_argument("--phrasings", type=pathlib.Path, help="questions in the words of others")
    words.add_argument("--written", action="store_true",
                       help="questions in the wordings that come with Engram")
    parser.add_argument("--bar", type=float, default=97, help="%% that should be right")
    parser.add_argument("--hostile", type=pathlib.Path,
                        help="texts that must be refused, JSON lines with a question each, "
                             "which is said `repeat` times")
    parser.add_argument("--days", type=int, default=0,
                        help="one store with a kitchen on each of so many days")
    parser.add_argument("--jobs", type=int, default=2, help="processes that simulate")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("build/ask"))
    parser.add_argument("--json", type=pathlib.Path, help="file for the figures")
    parser.add_argument("--rows", type=pathlib.Path, help="file for each question with its answer")
    parser.add_argument("--attention", type=pathlib.Path,
                        help="a network of engram learn-answers")
    parser.add_argument("--route", default="auto", choices=["auto", "program", "attention"])
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    stores = simulate_days(arguments) if arguments.days else simulate(arguments)
    by_store, lines = make_dialogues(arguments, stores)
    if lines:
        print("lines of {}: {lines}, asked {asked}, left out by --questions {left_out}, "
              "fit nothing {fit_nothing}".format(arguments.phrasings, **lines), flush=True)
    rows = judged(arguments, by_store)
    if arguments.rows:
        arguments.rows.write_text("".join(json.dumps(row) + "\n" for row in rows))
    figures = summary(rows)
    if lines:
        figures["phrasings"] = lines
    print_summary(figures, arguments.bar)
    if arguments.hostile:
        figures["hostile"] = hostile(arguments, stores[0])
        print("hostile texts refused: {refused} of {texts}, at most {max_ms:.1f} ms".format(
            **figures["hostile"]))
        for text in figures["hostile"]["answered"]:
            print(f"  answered: {text}")
    if arguments.json:
        arguments.json.write_text(json.dumps(figures, indent=2) + "\n")


if __name__ == "__main__":
    main()
