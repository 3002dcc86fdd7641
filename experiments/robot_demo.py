#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A robot that is asked to bring something, and everything that comes in its way.

    robot_demo.py ENGRAM FOLDER [--seed 1] [--thing salt_box] [--size fast|full] [--budget 30s]

"Bring me the salt" is said. A planner makes a plan and has the kitchen's skills carry it out: look,
drive, approach, pick, show it to Ada, place. "Stop!" is said while it reaches, and "Go on" resumes; a
chair is put in the way, so that the drive plans anew; a thing that comes into view is grasped because
of a condition. Then the memory is asked what happened, why, and why not, and the demonstration fails
if it cannot tell.
"""

from __future__ import annotations

import argparse
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import time

import numpy as np

import engram

#: Where Ada sits: x, y and the heading in which the robot faces her.
ADA = (1.6, -1.4, -0.7)
COMMANDS = "Speech/Commands/human/text"
PLANS = "Tasks/Plans/robot/plan"


def say(memory: engram.Memory, text: str, speaker: str = "Ada") -> None:
    print(f'[{clock()}] {speaker}: "{text}"', flush=True)
    memory.commit(COMMANDS, {"speaker": speaker, "text": text})


def clock() -> str:
    return f"{time.monotonic() - clock.begin:6.1f} s"


clock.begin = time.monotonic()


def last(memory: engram.Memory, query: str) -> list[engram.Snapshot]:
    try:
        found = memory.query(query)
    except engram.errors.NotFoundError:
        return []
    return [one for snapshots in found.values() for one in snapshots]


def named(memory: engram.Memory, words: str) -> str:
    """The object that somebody speaks of."""
    for one in last(memory, "Objects/Classes @ latest"):
        if one.value["spoken_name"].removeprefix("the ") in words:
            return "Objects/Instances/kitchen/" + one.entity.rsplit("/", 1)[1] + "_1"
    raise engram.SkillFailure(f"nobody knows what '{words}' is")


class Planner:
    """Turns words into plans, and plans into skills."""

    def __init__(self, memory: engram.Memory) -> None:
        self.memory = memory
        self.to_tidy = ""

    def steps(self, thing: str) -> list[tuple[str, dict]]:
        return [
            ("kitchen/look", {"object": thing}),
            ("kitchen/drive", {"to": "counter"}),
            ("kitchen/approach", {"object": thing}),
            ("kitchen/pick", {"object": thing}),
            ("kitchen/drive", {"to": "Ada"}),
            ("kitchen/drive", {"to": "table"}),
            ("kitchen/navigate", {"surface": "table"}),
            ("kitchen/place", {"surface": "table"}),
        ]

    def plan(self, goal: str, command: str, steps: list[tuple[str, dict]]) -> str:
        at = time.time_ns() // 1000 * 1000
        self.memory.commit(PLANS, {
            "goal": goal,
            "command": command,
            "steps": [{"skill": skill.split("/")[1], "object": given.get("object"), "surface":
                       "Objects/Surfaces/kitchen/" + given.get("surface", given.get("to"))
                       if {"surface", "to"} & given.keys() else None} for skill, given in steps],
        }, at)
        return f"{PLANS}/{time.strftime('%Y-%m-%d %H:%M:%S', time.gmtime(at // 10**9))}" \
               f".{at // 1000 % 10**6:06d}/0"

    def carry_out(self, run: engram.SkillRun, thing: str, command: str) -> str:
        steps = self.steps(thing)
        plan = self.plan(thing.rsplit("/", 1)[1] + " on the table", command, steps)
        run.report({"plan": len(steps)}, [plan, command])
        tries = 0
        while steps:
            skill, given = steps[0]
            end = engram.run_skill(self.memory, skill, given, wait=10, causes=[plan, command],
                                   requester="planner")
            print(f"[{clock()}] {skill} {given}: {end.outcome}: {end.reason}", flush=True)
            run.report({"step": skill, "outcome": end.outcome, "reason": end.reason}, [end.end])
            if end:
                steps.pop(0)
                continue
            tries += 1
            if tries > 6 or run.is_stopped:
                raise engram.SkillFailure(f"{skill}: {end.reason}")
            if end.outcome == "stop":
                self.wait_for(run, "go on")
            # A new plan for what is left, because of what came in between.
            plan = self.plan("the rest of it", command, steps)
            run.report({"plan": len(steps), "because": end.reason}, [plan, end.end])
        return f"brought {thing.rsplit('/', 1)[1]}"

    def wait_for(self, run: engram.SkillRun, words: str) -> None:
        with self.memory.watch(COMMANDS) as watch:
            while not run.is_stopped:
                heard = watch.next(0.2)
                if heard is not None and words in heard.value["text"].lower():
                    return


def skills_of(planner: Planner) -> list[engram.skills.Skill]:
    @engram.skill(r"""
name: bring
doc: Brings what somebody asks for.
parameters: {command: {type: link, doc: What was said.}}
conditions:
  when: {entity: Speech, path: text, matches: '(?i)bring me .*', new: true, binds: command}
timeout: 5min
stops_within: 20s
""")
    def bring(run, command):
        entity, at, _ = command.rsplit("/", 2)
        words = last(planner.memory, f"{entity} @ {at}")[0].value["text"].lower()
        return planner.carry_out(run, named(planner.memory, words), command)

    return [bring]


def tidy_of(planner: Planner) -> engram.skills.Skill:
    @engram.skill(r"""
name: tidy
doc: Picks up what comes into view on the table.
parameters: {thing: {type: link, doc: What came into view.}}
conditions:
  when:
    {entity: 'Objects/Instances/.*/THING', path: is_visible, equals: true, binds: thing}
  hold: {not: {entity: Speech, path: text, matches: '(?i)stop.*', new: true}}
timeout: 1min
""".replace("THING", planner.to_tidy))
    def tidy(run, thing):
        for skill in ("kitchen/approach", "kitchen/pick"):
            end = engram.run_skill(planner.memory, skill, {"object": thing}, wait=10,
                                   causes=[run.request, thing], requester="planner")
            print(f"[{clock()}] {skill} of {thing}: {end.outcome}: {end.reason}", flush=True)
            run.report({"step": skill, "outcome": end.outcome}, [end.end])
            if not end:
                raise engram.SkillFailure(end.reason)
        return "picked it up"

    return tidy


class Processes:
    """The server and the live kitchen; ended by their own process IDs."""

    def __init__(self, program: str, folder: pathlib.Path, options: list[str]) -> None:
        self.program = program
        self.folder = folder
        self.endpoint = f"unix:{folder}/s"
        self.bus = f"unix:{folder}/bus"
        self._running: list[subprocess.Popen] = []
        config = {"servers": [{"name": "robot", "listen": self.endpoint,
                               "store": str(folder / "robot.engram"), "preset": "balanced"}]}
        (folder / "robot.yaml").write_text(json.dumps(config))
        server = self._start("serve", "--config", str(folder / "robot.yaml"), "--json")
        if not server.stdout.readline():
            raise RuntimeError("the server did not start: see serve.log")
        self._start("simulate", "kitchen", "--live", "--server", self.endpoint, "--bus", self.bus,
                    *options)

    def _start(self, *words: str) -> subprocess.Popen:
        log = open(self.folder / f"{words[0]}.log", "w")
        process = subprocess.Popen([self.program, *words], stdout=subprocess.PIPE, stderr=log,
                                   text=True, start_new_session=True)
        self._running.append(process)
        return process

    def run(self, *words: str, server: bool = True) -> str:
        more = ["--server", self.endpoint] if server else []
        done = subprocess.run([self.program, *words, *more], capture_output=True, text=True,
                              timeout=600, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(words)}: {done.stderr}{done.stdout}")
        return done.stdout

    def poke(self, what: str) -> None:
        print(f"[{clock()}] {self.run('simulate', 'poke', what, '--bus', self.bus, server=False)}",
              end="", flush=True)

    def stop(self) -> None:
        for process in reversed(self._running):
            process.send_signal(signal.SIGTERM)
            process.communicate(timeout=120)
        self._running = []


def wait_until(what: str, is_so, seconds: float = 120) -> None:
    until = time.monotonic() + seconds
    while not is_so():
        if time.monotonic() > until:
            raise RuntimeError(f"waited {seconds} s in vain: {what}")
        time.sleep(0.1)


def events(memory: engram.Memory, skill: str) -> list[dict]:
    return [one.value for one in last(memory, f"Skill/Event/{skill} @ all")]


def is_running(memory: engram.Memory, skill: str) -> bool:
    return any(one.value["running"] for one in last(memory, f"Skill/Event/{skill} @ latest"))


def live(world: Processes, thing: str) -> None:
    """The two minutes."""
    memory = engram.connect(world.endpoint)
    wait_until("the kitchen has its skills", lambda: any(
        one.value["is_available"] for one in last(memory, "Skill/Executable/kitchen/drive @ latest")))
    memory.commit("Navigation/Location/people/ada", {
        "name": "Ada", "aliases": ["the window"], "pose_world_location": np.array(ADA),
        "object": "", "pose_object_location": None})
    planner = Planner(memory)
    with engram.SkillProvider("planner", world.endpoint) as provider:
        for one in skills_of(planner):
            provider.add(one)
        # Why not: nothing is in the hand.
        refused = engram.run_skill(memory, "kitchen/pick", {"object": thing, "hand": "up"},
                                   requester="ada")
        print(f"[{clock()}] pick with the hand 'up': {refused.outcome}: {refused.reason}")
        say(memory, f"Bring me the {thing.rsplit('/', 1)[1].split('_')[0]}.")
        wait_until("it picks", lambda: is_running(memory, "kitchen/pick"))
        time.sleep(1.0)
        say(memory, "Stop!")
        wait_until("it stopped", lambda: not is_running(memory, "kitchen/pick"))
        time.sleep(1.5)
        say(memory, "Go on.")
        wait_until("it drives to Ada", lambda: any(
            one["stage"] == 0 and "Ada" in one["parameters"]
            for one in events(memory, "kitchen/drive")))
        time.sleep(1.5)
        world.poke("chair to 0.75,-0.45")
        wait_until("it has been brought", lambda: any(
            one["stage"] == 2 for one in events(memory, "planner/bring")), 240)
        end = [one for one in events(memory, "planner/bring") if one["stage"] == 2][-1]
        print(f"[{clock()}] bring: {end['reason']}", flush=True)
        hidden = [one.entity.rsplit("/", 1)[1] for one in last(memory, "Objects/Instances @ latest")
                  if not one.value["is_visible"] and not one.value["held_by"]
                  and "chair" not in one.entity and "person" not in one.entity]
        planner.to_tidy = hidden[0]
        provider.add(tidy_of(planner))
        # The table is full: what was brought goes back.
        world.poke(f"{thing.rsplit('/', 1)[1].removesuffix('_1')} to counter")
        world.poke(f"{hidden[0].removesuffix('_1')} to table")
        # It comes into view as soon as the robot looks there.
        engram.run_skill(memory, "kitchen/look",
                         {"object": f"Objects/Instances/kitchen/{hidden[0]}"}, requester="ada")
        wait_until("it is tidied", lambda: any(
            one["stage"] == 2 for one in events(memory, "planner/tidy")), 60)
        end = [one for one in events(memory, "planner/tidy") if one["stage"] == 2][-1]
        print(f"[{clock()}] tidy: {end['reason']}", flush=True)
    memory.close()


def ask(folder: pathlib.Path) -> dict[str, object]:
    """What happened, why, why not: from the store alone."""
    memory = engram.open(folder / "robot.engram")
    found: dict[str, object] = {}
    runs = [one for one in last(memory, "Skill/Event @ all")]
    starts = {f"{one.entity}" for one in runs}
    found["skills"] = sorted(starts)
    ends = [one.value for one in runs if one.value["stage"] == 2]
    found["outcomes"] = {word: sum(1 for one in ends if one["outcome"] == number) for number, word
                         in enumerate(["running", "success", "failure", "stop", "lost"])}
    found["starts_and_ends"] = (sum(1 for one in runs if one.value["stage"] == 0), len(ends))
    drives = last(memory, "Navigation/Event/.*/.* @ all")
    found["replans"] = [one.value["reason"] for one in drives if one.value["kind"] in (1, 2)]
    found["by_condition"] = [one.value["causes"] for one in
                             last(memory, "Skill/ExecutionRequest/conditions @ all")]
    found["drive_events"] = [one.value["reason"] for one in drives]
    found["why_not"] = [one.value["reason"] for one in last(memory, "Skill/Refusal @ all")]
    stops = [one for one in ends if one["outcome"] == 3]
    found["stopped_by"] = [link for one in stops for link in one["stopped_by"]]
    # Why did it drive to the table? From the end of the drive to what was said, by links alone.
    why = []
    for one in ends:
        if one["skill"] != "kitchen/drive":
            continue
        request = value_at(memory, one["request"])
        causes = [value_at(memory, link) for link in request["causes"]]
        why.append([cause.get("goal") or cause.get("text") for cause in causes])
    found["why_drives"] = why
    return found


def value_at(memory: engram.Memory, link: str) -> dict:
    entity, at, index = link.rsplit("/", 2)
    return last(memory, f"{entity} @ {at}")[0].instances[int(index)].value


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("engram")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--thing", default="salt_box")
    parser.add_argument("--size", choices=["fast", "full"], default="fast")
    parser.add_argument("--budget", default="30s", help="time that the night may take to learn")
    parser.add_argument("--json", type=pathlib.Path, help="also writes what was found there")
    arguments = parser.parse_args()
    folder = arguments.folder.resolve()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    options = ["--seed", str(arguments.seed)] + (["--fast"] if arguments.size == "fast" else [])
    world = Processes(arguments.engram, folder, options)
    try:
        live(world, f"Objects/Instances/kitchen/{arguments.thing}_1")
    finally:
        world.stop()
    store = str(folder / "robot.engram")
    # The night that follows.
    world.run("consolidate", store, "--budget", arguments.budget, server=False)
    found = ask(folder)
    print(json.dumps(found, indent=1))
    if arguments.json:
        arguments.json.write_text(json.dumps(found, indent=1) + "\n")
    starts, ends = found["starts_and_ends"]
    missing = [what for what, is_so in {
        "each start has an end": starts == ends,
        "what stopped it": found["stopped_by"],
        "why not": found["why_not"],
        "why it drove": found["why_drives"] and all(
            any("Bring me" in (text or "") for text in chain) for chain in found["why_drives"]),
        "that it planned anew": found["replans"],
        "what was tidied because of a condition": found["by_condition"],
    }.items() if not is_so]
    for what in missing:
        print(f"robot_demo: the memory does not tell {what}", file=sys.stderr)
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
