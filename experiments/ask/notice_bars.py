#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Deeds that nobody told: how rightly `engram notice` finds them in joints, and what can be asked.

    notice_bars.py ENGRAM [--kitchens FOLDER] [--recording FOLDER] [--work FOLDER] [--json FILE]

Kitchens are asked for the grasps that their skills tell, and these are compared with what is found
in the joints alone: a grasp that succeeded should be found, with the right hand, while it was carried
out or a second later; what is found should be a grasp, or an attempt of one. The recording of a real
robot (LeRobot's layout) has no such truth; there the deeds of each episode are counted, and ten
questions are printed with their answers.
"""

from __future__ import annotations

import argparse
import json
import pathlib
import shutil
import subprocess
import sys
from datetime import datetime, timedelta

QUESTIONS = [
    "When did you grasp the {thing}?",
    "When did you first pick up the {thing}?",
    "How often did you pick up the {thing}?",
    "Which hand did you use to grasp the {thing}?",
    "Where did you take the {thing} from?",
    "How long did it take to grasp the {thing} the last time?",
    "Why did you pick up the {thing}?",
    "When did you let go of the {thing}?",
    "Did you pick up anything with your left hand?",
    "Did you pick up the elephant?",
]
#: The hand stands a moment after the skill says that it holds.
LATE = timedelta(seconds=1)


def run(engram: str, *words: str) -> str:
    done = subprocess.run([engram, *words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(words)}: {done.stderr}")
    return done.stdout


def time_of(when: str | int) -> datetime:
    """A time as Engram prints it, or in nanoseconds; what is less than a microsecond is cut off."""
    if isinstance(when, int):
        return datetime(1970, 1, 1) + timedelta(microseconds=when // 1000)
    return datetime.fromisoformat(when[:26])


def told_picks(engram: str, store: pathlib.Path) -> list[dict]:
    """The grasps that the skills of a kitchen told, with their outcomes (1: success)."""
    answer = json.loads(run(engram, "query", str(store), "Skill/Event/robot/pick @ all", "--json"))
    events = [instance["data"] for entity in answer["entities"]
              for snapshot in entity["snapshots"] for instance in snapshot["instances"]]
    ended = [{key: plain(one[key]) for key in ("stage", "hand", "outcome", "started", "ended")}
             for one in events]
    return [{"hand": one["hand"], "outcome": one["outcome"], "from": time_of(one["started"]),
             "to": time_of(one["ended"])} for one in ended if one["stage"] == 2]


def plain(value: object) -> object:
    """A value without the mark of its type; 64 bits are a text in JSON."""
    if isinstance(value, dict):
        (mark, value), = value.items()
        return int(value) if mark == "$int64" else value
    return value


def measure_kitchens(engram: str, folder: pathlib.Path) -> dict:
    counts = {"kitchens": 0, "grasps": 0, "found": 0, "deeds": 0, "of_success": 0, "of_attempts": 0}
    for store in sorted(folder.glob("*.engram")):
        told = told_picks(engram, store)
        deeds = json.loads(run(engram, "notice", str(store), "--json"))["deeds"]
        took = [(one["hand"], time_of(one["took"])) for one in deeds]

        def is_of(pick: dict, hand: str, when: datetime) -> bool:
            return pick["hand"] == hand and pick["from"] <= when <= pick["to"] + LATE

        good = [pick for pick in told if pick["outcome"] == 1]
        counts["kitchens"] += 1
        counts["grasps"] += len(good)
        counts["found"] += sum(any(is_of(pick, *one) for one in took) for pick in good)
        counts["deeds"] += len(took)
        counts["of_success"] += sum(any(is_of(pick, *one) for pick in good) for one in took)
        counts["of_attempts"] += sum(any(is_of(pick, *one) for pick in told) for one in took)
    return counts


def measure_recording(engram: str, recording: pathlib.Path, work: pathlib.Path) -> dict:
    store = work / "recording.engram"
    if store.exists():
        shutil.rmtree(store)
    run(engram, "import", "--from", str(recording), "--rate", "10", str(store))
    found = json.loads(run(engram, "notice", str(store), "--commit", "--json"))
    by_episode: dict[str, int] = {}
    for deed in found["deeds"]:
        by_episode[deed["episode"]] = by_episode.get(deed["episode"], 0) + 1
    things = {deed["thing"] for deed in found["deeds"] if deed["thing"]}
    thing = sorted(things)[0].split()[-1] if things else "thing"
    asked = []
    for question in (one.format(thing=thing) for one in QUESTIONS):
        answer = json.loads(run(engram, "ask", str(store), question, "--json"))
        asked.append({"question": question, "text": answer["text"],
                      "evidence": [one["id"] for one in answer["evidence"]]})
    return {"episodes": found["episodes"], "deeds": len(found["deeds"]),
            "episodes_with_one": sum(count == 1 for count in by_episode.values()),
            "questions": asked}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("engram")
    parser.add_argument("--kitchens", type=pathlib.Path, help="stores of simulated kitchens")
    parser.add_argument("--recording", type=pathlib.Path, help="a LeRobot recording")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("build/notice"))
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    report: dict = {}
    if arguments.kitchens:
        counts = report["kitchens"] = measure_kitchens(arguments.engram, arguments.kitchens)
        print(f"{counts['kitchens']} kitchens: of {counts['grasps']} grasps that succeeded "
              f"{counts['found']} are found in the joints; of {counts['deeds']} deeds that are found "
              f"{counts['of_success']} are such grasps, and {counts['of_attempts']} grasps or attempts")
    if arguments.recording:
        found = report["recording"] = measure_recording(arguments.engram, arguments.recording,
                                                        arguments.work)
        print(f"{arguments.recording.name}: {found['deeds']} deeds in {found['episodes']} episodes, "
              f"exactly one in {found['episodes_with_one']}")
        for one in found["questions"]:
            print(f"\n{one['question']}\n  {one['text'][:300]}")
            for link in one["evidence"][:5]:
                print(f"    {link}")
    if arguments.json:
        arguments.json.write_text(json.dumps(report, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
