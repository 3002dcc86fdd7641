#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A robot that is asked to bring something, and everything that comes in its way.

    robot_demo.py ENGRAM FOLDER [--seed 1] [--thing salt_box] [--size fast|full] [--budget 30s]
                  [--stepped]

"Bring me the salt" is said. A planner makes a plan and has the kitchen's skills carry it out: look,
drive, approach, pick, show it to Ada, place. "Stop!" is said while it reaches, and "Go on" resumes; a
chair is put in the way, so that the drive plans anew; a thing that comes into view is grasped because
of a condition. Then the memory is asked what happened, why, and why not, and the demonstration fails
if it cannot tell, or if a link of what it tells leads nowhere.

With --stepped the kitchen's time is held, and passes only while this lets it (docs/kitchen.md,
section "Steps"): a slow machine then does not change what comes after what.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import traceback

import numpy as np

import engram

#: Where Ada sits: x, y and the heading in which the robot faces her.
ADA = (1.6, -1.4, -0.7)
COMMANDS = "Speech/Commands/human/text"
PLANS = "Tasks/Plans/robot/plan"
#: What the server keeps: five images and states a second, but each snapshot that others link to. A thing
#: may come into view at any moment, and a skill that starts then names that snapshot as its cause.
RECORDING = {"entities": [
    {"match": "Skills?|Speech|Tasks|Navigation|Objects", "name": "deeds", "filters": [],
     "codecs": [{"kind": "image", "codec": "png"}]},
    {"match": ".*", "name": "everything", "filters": [{"frequency": {"rate": "5Hz"}}],
     "codecs": [{"kind": "image", "codec": "png"}]}]}
#: It says that a folder was made by this program, so that it may be replaced.
MARK = "made-by-robot-demo"


class WallTime:
    """Time that passes by itself."""

    #: What the kitchen and its server are told besides.
    kitchen_options: list[str] = []
    skill_clock = None

    def __init__(self, memory: engram.Memory) -> None:
        self.memory = memory
        self._last = 0
        self._lock = threading.Lock()

    def now(self) -> int:
        return time.time_ns()

    def stamp(self) -> int:
        """A time of now that nobody had before. IDs have six digits of a second."""
        now = self.now() // 1000 * 1000
        with self._lock:
            self._last = max(self._last + 1000, now)
            return self._last

    def sleep(self, seconds: float) -> None:
        time.sleep(seconds)

    def look_later(self) -> float:
        """Waits until it is worth looking again. Returns how long at most."""
        self.sleep(0.1)
        return 0.1

    def until(self, what: str, is_so, seconds: float = 120) -> None:
        waited = 0.0
        while not is_so():
            if waited > seconds:
                raise RuntimeError(f"waited {seconds} s in vain: {what}")
            waited += self.look_later()

    def run(self, skill: str, given: dict) -> engram.SkillResult:
        return engram.run_skill(self.memory, skill, given, requester="ada")


class HeldTime(WallTime):
    """Time of a kitchen that stands still but while the skill `pass` runs."""

    kitchen_options = ["--stepped", "--held"]
    skill_clock = "RobotState/Localization/robot/platform"

    def now(self) -> int:
        return last(self.memory, f"{self.skill_clock} @ latest")[0].time

    def sleep(self, seconds: float, until_end: bool = False) -> None:
        passed = engram.run_skill(self.memory, "kitchen/pass",
                                  {"seconds": float(seconds), "until_end": until_end},
                                  requester="time")
        if not passed:
            raise RuntimeError(f"time does not pass: {passed.reason}")

    def look_later(self) -> float:
        self.sleep(0.4, until_end=True)
        return 0.4

    def run(self, skill: str, given: dict) -> engram.SkillResult:
        ended: concurrent.futures.Future[engram.SkillResult] = concurrent.futures.Future()

        def wait_for_end() -> None:
            try:
                ended.set_result(WallTime.run(self, skill, given))
            except Exception as error:  # pylint: disable=broad-except
                ended.set_exception(error)

        # A daemon: where time no longer passes, the skill never ends, and nobody waits for it.
        threading.Thread(target=wait_for_end, daemon=True).start()
        self.until(f"{skill} ends", ended.done)
        return ended.result()


def say(memory: engram.Memory, clock_of: WallTime, text: str, speaker: str = "Ada") -> None:
    print(f'[{clock()}] {speaker}: "{text}"', flush=True)
    memory.commit(COMMANDS, {"speaker": speaker, "text": text}, clock_of.stamp())


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


def surface_of(given: dict) -> str | None:
    name = given.get("surface", given.get("to"))
    return f"Objects/Surfaces/kitchen/{name}" if name in ("counter", "table") else None


class Planner:
    """Turns words into plans, and plans into skills."""

    def __init__(self, memory: engram.Memory, clock_of: WallTime) -> None:
        self.memory = memory
        self.clock = clock_of
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
        at = self.clock.stamp()
        self.memory.commit(PLANS, {
            "goal": goal,
            "command": command,
            "steps": [{"skill": skill.split("/")[1], "object": given.get("object"),
                       "surface": surface_of(given)} for skill, given in steps],
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


class Processes(contextlib.AbstractContextManager):
    """The server and the live kitchen; ended by their own process IDs."""

    def __init__(self, program: str, folder: pathlib.Path, options: list[str],
                 skill_clock: str | None) -> None:
        self.program = program
        self.folder = folder
        self.endpoint = f"unix:{folder}/s"
        self.bus = f"unix:{folder}/bus"
        self._options = options
        self._skill_clock = skill_clock
        self._running = contextlib.ExitStack()

    def __enter__(self) -> Processes:
        server = {"name": "robot", "listen": self.endpoint,
                  "store": str(self.folder / "robot.engram"),
                  "recording": str(self.folder / "recording.yaml")}
        if self._skill_clock:
            server["skills"] = {"clock": self._skill_clock}
        (self.folder / "recording.yaml").write_text(json.dumps(RECORDING))
        (self.folder / "robot.yaml").write_text(json.dumps({"servers": [server]}))
        with contextlib.ExitStack() as begun:
            serve = begun.enter_context(self._start("serve", "--config",
                                                    str(self.folder / "robot.yaml"), "--json"))
            # It says in a line of JSON where it listens.
            while not (self.folder / "serve.out").read_text().endswith("\n"):
                if serve.poll() is not None:
                    raise RuntimeError(f"the server did not start: see {self.folder}/serve.log")
                time.sleep(0.05)
            begun.enter_context(self._start("simulate", "kitchen", "--live", "--server",
                                            self.endpoint, "--bus", self.bus, *self._options))
            self._running = begun.pop_all()
        return self

    def __exit__(self, *_error: object) -> None:
        self._running.close()

    @contextlib.contextmanager
    def _start(self, *words: str):
        """Its output goes to files: a pipe that nobody reads would hold it up once it is full."""
        with open(self.folder / f"{words[0]}.log", "w") as log, \
                open(self.folder / f"{words[0]}.out", "w") as out:
            process = subprocess.Popen([self.program, *words], stdin=subprocess.DEVNULL, stdout=out,
                                       stderr=log, start_new_session=True)
            try:
                yield process
            finally:
                ended = process.poll()
                process.send_signal(signal.SIGTERM)
                try:
                    process.wait(timeout=120)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
            if ended is not None or process.returncode not in (0, 128 + signal.SIGTERM):
                raise RuntimeError(f"{words[0]} ended with {process.returncode}"
                                   f"{'' if ended is None else ' before its time'}: see {log.name}")

    def run(self, *words: str) -> str:
        done = subprocess.run([self.program, *words], capture_output=True, text=True,
                              timeout=600, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(words)}: {done.stderr}{done.stdout}")
        return done.stdout

    def poke(self, what: str) -> None:
        print(f"[{clock()}] {self.run('simulate', 'poke', what, '--bus', self.bus)}", end="",
              flush=True)


def events(memory: engram.Memory, skill: str) -> list[dict]:
    return [one.value for one in last(memory, f"Skill/Event/{skill} @ all")]


def is_running(memory: engram.Memory, skill: str) -> bool:
    return any(one.value["running"] for one in last(memory, f"Skill/Event/{skill} @ latest"))


def live(world: Processes, thing: str, of: type[WallTime]) -> None:
    """The two minutes."""
    with engram.connect(world.endpoint) as memory:
        # Before that nobody can let held time pass.
        WallTime(memory).until("the kitchen has its skills", lambda: any(
            one.value["is_available"]
            for one in last(memory, "Skill/Executable/kitchen/drive @ latest")))
        WallTime(memory).until("what is known before is in the memory", lambda: all(
            last(memory, f"{kind} @ latest") for kind in ("Objects/Classes", "Objects/Instances")))
        now = of(memory)
        # What the robot senses is in the memory then, and with it the time.
        now.sleep(0.1)
        ask_for(world, memory, thing, now)


@contextlib.contextmanager
def given_up(world: Processes):
    """Ends this program at once where what it encloses fails. A planner waits for skills, and where
    held time no longer passes they never end, so leaving its provider would wait for ever."""
    try:
        yield
    except BaseException:  # pylint: disable=broad-except
        traceback.print_exc()
        with contextlib.suppress(RuntimeError):
            world.__exit__(None, None, None)
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(1)


def ask_for(world: Processes, memory: engram.Memory, thing: str, now: WallTime) -> None:
    memory.commit("Navigation/Location/people/ada", {
        "name": "Ada", "aliases": ["the window"], "pose_world_location": np.array(ADA),
        "object": "", "pose_object_location": None}, now.stamp())
    planner = Planner(memory, now)
    with engram.SkillProvider("planner", world.endpoint) as provider, given_up(world):
        for one in skills_of(planner):
            provider.add(one)
        # Why not: nothing is in the hand.
        refused = now.run("kitchen/pick", {"object": thing, "hand": "up"})
        print(f"[{clock()}] pick with the hand 'up': {refused.outcome}: {refused.reason}")
        say(memory, now, f"Bring me the {thing.rsplit('/', 1)[1].split('_')[0]}.")
        now.until("it picks", lambda: is_running(memory, "kitchen/pick"))
        now.sleep(1.0)
        say(memory, now, "Stop!")
        now.until("it stopped", lambda: not is_running(memory, "kitchen/pick"))
        now.sleep(1.5)
        say(memory, now, "Go on.")
        now.until("it drives to Ada", lambda: any(
            one["stage"] == 0 and "Ada" in one["parameters"]
            for one in events(memory, "kitchen/drive")))
        now.sleep(1.5)
        world.poke("chair to 0.75,-0.45")
        now.until("it has been brought", lambda: any(
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
        now.run("kitchen/look", {"object": f"Objects/Instances/kitchen/{hidden[0]}"})
        now.until("it is tidied", lambda: any(
            one["stage"] == 2 for one in events(memory, "planner/tidy")), 60)
        end = [one for one in events(memory, "planner/tidy") if one["stage"] == 2][-1]
        print(f"[{clock()}] tidy: {end['reason']}", flush=True)


#: An entity, or one of its snapshots, or a value in one.
LINK = re.compile(r"[A-Z]\w*(/[^/]+){3}(/\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d+(/\d+)?)?")


def links_in(value: object) -> list[str]:
    """All links in a value, and in the JSON that some texts are."""
    if isinstance(value, str):
        if LINK.fullmatch(value):
            return [value]
        with contextlib.suppress(ValueError):
            if value.startswith(("{", "[")):
                return links_in(json.loads(value))
        return []
    if hasattr(value, "keys"):
        return [link for key in value.keys() for link in links_in(value[key])]
    if isinstance(value, (list, tuple)):
        return [link for one in value for link in links_in(one)]
    return []


def resolves(memory: engram.Memory, link: str) -> bool:
    parts = link.split("/")
    when = parts[4] if len(parts) > 4 else "latest"
    found = last(memory, f"{'/'.join(parts[:4])} @ {when}")
    return bool(found) and (len(parts) < 6 or int(parts[5]) < len(found[0].instances))


def unresolved_links(memory: engram.Memory) -> tuple[int, list[str]]:
    """How many different links the run left, and those of them that lead nowhere."""
    links = {link for query in ("Skill @ all", "Navigation @ all", "Tasks @ all")
             for snapshot in last(memory, query) for instance in snapshot.instances
             for link in links_in(instance.value)}
    return len(links), sorted(link for link in links if not resolves(memory, link))


def ask(folder: pathlib.Path) -> dict[str, object]:
    """What happened, why, why not: from the store alone."""
    with engram.open(folder / "robot.engram") as memory:
        return answers(memory)


def answers(memory: engram.Memory) -> dict[str, object]:
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
    found["links"], found["unresolved_links"] = unresolved_links(memory)
    return found


def value_at(memory: engram.Memory, link: str) -> dict:
    entity, at, index = link.rsplit("/", 2)
    return last(memory, f"{entity} @ {at}")[0].instances[int(index)].value


def prepare(folder: pathlib.Path) -> None:
    """Makes the folder anew, if it is ours or empty."""
    if folder.exists() and not (folder / MARK).exists() and any(folder.iterdir()):
        raise SystemExit(f"robot_demo: '{folder}' has files that this program did not "
                         "make; it needs a folder that is empty or not there")
    if folder.exists():
        shutil.rmtree(folder)
    folder.mkdir(parents=True)
    (folder / MARK).touch()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("engram")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--thing", default="salt_box")
    parser.add_argument("--size", choices=["fast", "full"], default="fast")
    parser.add_argument("--budget", default="30s", help="time that the night may take to learn")
    parser.add_argument("--stepped", action="store_true", help="the kitchen's time is held")
    parser.add_argument("--json", type=pathlib.Path, help="also writes what was found there")
    arguments = parser.parse_args()
    folder = arguments.folder.resolve()
    prepare(folder)
    of = HeldTime if arguments.stepped else WallTime
    options = ["--seed", str(arguments.seed), *of.kitchen_options]
    if arguments.size == "fast":
        options.append("--fast")
    with Processes(arguments.engram, folder, options, of.skill_clock) as world:
        live(world, f"Objects/Instances/kitchen/{arguments.thing}_1", of)
    # The night that follows.
    world.run("consolidate", str(folder / "robot.engram"), "--budget", arguments.budget)
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
        "where each of its links leads": found["links"] and not found["unresolved_links"],
    }.items() if not is_so]
    for what in missing:
        print(f"robot_demo: the memory does not tell {what}", file=sys.stderr)
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
