#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How often does `engram ask` answer rightly, refuse rightly, and how soon?

Kitchens without images are simulated, of seeds that nothing was trained on. Questions with true
answers are made of each (docs/dialogues.md), asked of its store, and judged. The blind baseline
gives each form of question its commonest answer in the other kitchens.
"""
import argparse
import collections
import json
import pathlib
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
    folder = arguments.work / f"kitchens-{arguments.seconds:g}s"
    folder.mkdir(parents=True, exist_ok=True)
    stores = {seed: folder / f"kitchen-{seed}.engram" for seed in arguments.seeds}
    # A store whose simulation was stopped has no mark beside it.
    missing = [seed for seed, store in stores.items() if not store.with_suffix(".done").exists()]
    for seed in missing:
        subprocess.run(["rm", "-rf", "--", str(stores[seed])], check=True)
    begin = time.perf_counter()
    if missing:
        run(arguments.engram, "simulate", "kitchen", "--folder", folder, "--no-images",
            "--seconds", arguments.seconds, "--jobs", arguments.jobs, "--progress", "none",
            "--seed", ",".join(map(str, missing)))
        for seed in missing:
            stores[seed].with_suffix(".done").touch()
        took = time.perf_counter() - begin
        print(f"{len(missing)} kitchens of {arguments.seconds:g} s in {took:.0f} s: "
              f"{took / len(missing):.1f} s each with {arguments.jobs} processes", flush=True)
    return list(stores.values())


def simulate_days(arguments):
    """One store with a kitchen on each day, all of other seeds."""
    store = arguments.work / f"days-{arguments.days}-{arguments.seconds:g}s.engram"
    if not store.with_suffix(".done").exists():
        subprocess.run(["rm", "-rf", "--", str(store)], check=True)
        for day in range(arguments.days):
            run(arguments.engram, "simulate", "kitchen", store, "--no-images", "--seed",
                arguments.seeds[0] + day, "--seconds", arguments.seconds, "--progress", "none",
                "--start", f"2026-03-{1 + day:02} 09:00:00" if day < 31
                else f"2026-04-{day - 30:02} 09:00:00")
        store.with_suffix(".done").touch()
    return [store]


def make_dialogues(arguments, stores):
    words = ["--phrasings", arguments.phrasings] if arguments.phrasings else []
    count = -(-arguments.questions // len(stores))
    by_store = {}
    for number, store in enumerate(stores):
        lines = run(arguments.make_dialogues, store, "--count", count, "--seed",
                    arguments.seed + number, "--split", arguments.split, "--careless",
                    arguments.careless, *words)
        by_store[store] = [json.loads(line) for line in lines.splitlines()]
    # The last ones of some kitchens, where the count is no multiple.
    return trimmed(by_store, arguments.questions)


def trimmed(by_store, count):
    too_many = sum(map(len, by_store.values())) - count
    for store in reversed(list(by_store)):
        if too_many > 0 and by_store[store]:
            by_store[store].pop()
            too_many -= 1
    return by_store


def ask(arguments, store, dialogues):
    file = arguments.work / "questions.jsonl"
    file.write_text("".join(json.dumps({"question": one["question"], "now": one["now"]}) + "\n"
                            for one in dialogues))
    lines = run(arguments.engram, "ask", store, "--questions", file, "--json",
                *arguments.ask_options).splitlines()
    answers = [json.loads(line) for line in lines if line.strip()]
    if len(answers) != len(dialogues):
        sys.exit(f"{store}: {len(dialogues)} questions got {len(answers)} answers")
    return answers


def known_ids(arguments, store):
    """The IDs of all that an answer may show."""
    return set(json.loads(run(arguments.engram, "query", store, "?ids .* @ all", "--json"))["ids"])


def is_known(ids, one):
    """Whether the memory has what an answer shows: an instance, a snapshot or an entity."""
    return one in ids or any(other.startswith(one + "/") for other in ids)


def blind_answers(by_store):
    """The commonest answer to each form in the other kitchens, as an answer of `engram ask`."""
    counts = collections.defaultdict(lambda: collections.defaultdict(collections.Counter))
    for store, dialogues in by_store.items():
        for one in dialogues:
            counts[one["form"]][store][json.dumps(one["value"])] += 1

    def blind(store, dialogue):
        total = collections.Counter()
        for other, counter in counts[dialogue["form"]].items():
            if other != store:
                total.update(counter)
        return {"value": json.loads(max(total, key=total.get)) if total else {"kind": "unknown"}}

    return blind


def percentile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, round(share * (len(values) - 1)))] if values else None


def judged(arguments, by_store):
    """A row of figures for each dialogue."""
    blind = blind_answers(by_store)
    rows = []
    for store, dialogues in by_store.items():
        answers = ask(arguments, store, dialogues)
        ids = known_ids(arguments, store)
        for dialogue, answer in zip(dialogues, answers):
            shown = judge.shown(answer)
            rows.append({
                "dialogue": dialogue, "answer": answer,
                "right": judge.is_right(dialogue, answer), "refused": judge.is_refused(answer),
                "blind": judge.is_right(dialogue, blind(store, dialogue)),
                # What is said needs evidence that exists, and what is right must be shown by it.
                "has_evidence": bool(shown) and all(is_known(ids, one) for one in shown),
                "is_shown": judge.is_shown(dialogue, answer),
                "took_ms": answer.get("took_ms")})
    return rows


def hostile(arguments, store):
    """How texts that are no questions to a robot are taken: one of `answered` is worth a look."""
    texts = [json.loads(line) for line in arguments.hostile.read_text().splitlines() if line]
    now = "2100-01-01 00:00:00"
    answers = ask(arguments, store, [{"question": one["question"], "now": now} for one in texts])
    answered = [one["question"][:80] for one, answer in zip(texts, answers)
                if not judge.is_refused(answer)]
    return {"texts": len(texts), "refused": len(texts) - len(answered), "answered": answered,
            "max_ms": max(answer.get("took_ms") or 0 for answer in answers)}


def share(rows, name):
    return sum(row[name] for row in rows) / len(rows) if rows else None


def summary(rows):
    answerable = [row for row in rows if row["dialogue"]["answerable"]]
    said = [row for row in rows if not row["refused"]]
    right = [row for row in said if row["right"]]
    took = [row["took_ms"] for row in rows if row["took_ms"] is not None]
    families = {}
    for family in FAMILIES:
        of = [row for row in rows if row["dialogue"]["family"] == family]
        if of:
            families[family] = {"questions": len(of), "right": share(of, "right"),
                                "refused": share(of, "refused"), "blind": share(of, "blind")}
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
        "said": len(said), "said_with_evidence": share(said, "has_evidence"),
        "right_and_shown": share(right, "is_shown"),
        "p50_ms": percentile(took, 0.5), "p95_ms": percentile(took, 0.95),
        "families": families, "held_out": held_out}


def percent(value):
    return "-" if value is None else f"{100 * value:.1f} %"


def print_summary(figures):
    print(f"{'family':15} {'questions':>9} {'right':>8} {'refused':>8} {'blind':>8}")
    for family, one in figures["families"].items():
        print(f"{family:15} {one['questions']:9} {percent(one['right']):>8} "
              f"{percent(one['refused']):>8} {percent(one['blind']):>8}")
    for what, one in figures["held_out"].items():
        print(f"new {what + ':':11} {one['questions']:9} {percent(one['right']):>8}")
    rows = [("right, of what can be answered", percent(figures["right"]), "97 %"),
            ("the same, blind", percent(figures["blind"]), "printed"),
            ("refused, of what cannot be", percent(figures["unanswerable_refused"]), "95 %"),
            ("said with evidence that exists", percent(figures["said_with_evidence"]), "100 %"),
            ("right, and shown by its evidence", percent(figures["right_and_shown"]), "printed")]
    for name, ms, bar in (("p50", figures["p50_ms"], 50), ("p95", figures["p95_ms"], 300)):
        rows.append((f"time to answer, {name}", "-" if ms is None else f"{ms:.1f} ms", f"{bar} ms"))
    print()
    for name, value, bar in rows:
        print(f"{name:34} {value:>9}   bar {bar}")


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
    parser.add_argument("--phrasings", type=pathlib.Path, help="questions in the words of others")
    parser.add_argument("--hostile", type=pathlib.Path,
                        help="texts that must be refused, JSON lines with a question each")
    parser.add_argument("--days", type=int, default=0,
                        help="one store with a kitchen on each of so many days (max 61)")
    parser.add_argument("--jobs", type=int, default=2, help="processes that simulate")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("build/ask"))
    parser.add_argument("--json", type=pathlib.Path, help="file for the figures")
    parser.add_argument("--rows", type=pathlib.Path, help="file for each question with its answer")
    parser.add_argument("--ask-options", nargs="*", default=[], help="more options of engram ask")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    stores = simulate_days(arguments) if arguments.days else simulate(arguments)
    by_store = make_dialogues(arguments, stores)
    rows = judged(arguments, by_store)
    if arguments.rows:
        arguments.rows.write_text("".join(json.dumps(row) + "\n" for row in rows))
    figures = summary(rows)
    print_summary(figures)
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
