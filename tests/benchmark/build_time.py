#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a fresh release build costs: processor time in all, per room, and of the dearest sources.

    build_time.py [--build build/bench] [--jobs 2] [--target engram_core ...] [--json]
    build_time.py --report build/bench [--json]

Without --report it removes the build folder, configures it as the preset `release` does but without
ccache, and builds. note_time.py starts each compiler and linker, and notes what the kernel says that
it used (user and system time): ninja's log knows only how long a step took, and steps that run
beside each other slow each other down. What is neither compiled nor linked by a compiler (archives,
generated code) has the time of ninja's log.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import pathlib
import shutil
import subprocess
import sys

import note_time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
NOTES = "processor_time.jsonl"
TOTAL = "processor_time_total.json"


@dataclasses.dataclass
class Step:
    """One step of a build."""
    output: str               # Relative to the build folder.
    wall_s: float             # By ninja's log.
    processor_s: float | None = None  # Nothing: nobody measured it.
    source: str = ""          # Relative to the sources, or to the build folder if it was generated.

    @property
    def seconds(self) -> float:
        return self.wall_s if self.processor_s is None else self.processor_s


def steps_of_log(text: str) -> list[Step]:
    """Steps of a .ninja_log, version 5 or later: the last run of each output counts.

    A step of several outputs has a line for each, of the same times and command: it counts once.
    """
    last: dict[str, tuple[int, int, str]] = {}
    for line in text.splitlines():
        fields = line.split("\t")
        if line.startswith("#") or len(fields) != 5:
            continue
        last[fields[3]] = (int(fields[0]), int(fields[1]), fields[4])
    steps: dict[tuple[int, int, str], Step] = {}
    for output, key in last.items():
        steps.setdefault(key, Step(output, (key[1] - key[0]) / 1000))
    return list(steps.values())


def add_notes(steps: list[Step], text: str) -> None:
    """Adds what the launcher noted: a line of JSON per step, the last one of an output counts."""
    notes = {}
    for line in text.splitlines():
        note = json.loads(line)
        notes[note["output"]] = note
    for step in steps:
        if note := notes.get(step.output):
            step.processor_s = note["user_s"] + note["system_s"]
            step.source = note["source"]


def room_of(step: Step) -> str:
    """Where the source of a step lives, with two levels as in docs/design.md, section 3."""
    if "cmake_pch" in step.output:
        return "(precompiled headers)"
    if not step.source:
        return "(linked)" if step.processor_s is not None else "(other steps)"
    if "/Unity/" in step.source:  # Sources of a room that are compiled together.
        return "/".join(pathlib.PurePath(step.output).parts[:2]).removesuffix("/CMakeFiles")
    if not (SOURCE / step.source).exists():
        return "(generated)"
    return "/".join(pathlib.PurePath(step.source).parts[:-1][:2])


def report_of(steps: list[Step], total: dict[str, float] | None, top: int) -> dict:
    rooms: dict[str, list[float]] = {}
    for step in steps:
        rooms.setdefault(room_of(step), []).append(step.seconds)
    compiled = sorted((step for step in steps if step.source), key=lambda step: -step.seconds)
    return {
        "total_s": total["user_s"] + total["system_s"] if total else sum(s.seconds for s in steps),
        "is_measured": total is not None,
        "wall_s": total["wall_s"] if total else None,
        "unmeasured_s": sum(step.wall_s for step in steps if step.processor_s is None),
        "steps": len(steps),
        "rooms": [{"room": room, "seconds": sum(all_of), "steps": len(all_of)}
                  for room, all_of in sorted(rooms.items(), key=lambda one: -sum(one[1]))],
        "dearest": [{"source": step.source, "output": step.output, "seconds": step.seconds}
                    for step in compiled[:top]],
    }


def text_of(report: dict) -> str:
    lines = [f"processor time   {report['total_s'] / 60:8.1f} min, {report['steps']} steps"]
    if report["is_measured"]:
        lines.append(f"took             {report['wall_s'] / 60:8.1f} min")
    else:
        lines.append("Nothing measured it: these are the times of ninja's log, which count too much "
                     "where steps ran beside each other.")
    lines.append(f"\n{'room':<28}{'seconds':>10}{'steps':>8}")
    lines += [f"{one['room']:<28}{one['seconds']:>10.1f}{one['steps']:>8}" for one in report["rooms"]]
    lines.append(f"\n{'dearest sources':<58}{'seconds':>10}")
    lines += [f"{one['source']:<58}{one['seconds']:>10.1f}" for one in report["dearest"]]
    return "\n".join(lines)


def read_report(build: pathlib.Path, top: int) -> dict:
    steps = steps_of_log((build / ".ninja_log").read_text())
    if (build / NOTES).exists():
        add_notes(steps, (build / NOTES).read_text())
    total = build / TOTAL
    return report_of(steps, json.loads(total.read_text()) if total.exists() else None, top)


def build_fresh(build: pathlib.Path, jobs: int, targets: list[str], configured: list[str]) -> None:
    shutil.rmtree(build, ignore_errors=True)
    launcher = ";".join([sys.executable, "-I", "-S", note_time.__file__, str(build / NOTES),
                         str(build), str(SOURCE)])
    subprocess.run(["cmake", "--preset", "release", "-B", build, "-S", SOURCE, "-DENGRAM_CCACHE=",
                    f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}",
                    f"-DCMAKE_CXX_LINKER_LAUNCHER={launcher}", *configured],
                   check=True, cwd=SOURCE, stdout=subprocess.DEVNULL)
    command = ["ninja", "-C", str(build), f"-j{jobs}", *targets]
    code, used = note_time.run(command, output=sys.stderr.fileno())
    if code:
        sys.exit(code)
    (build / TOTAL).write_text(json.dumps(used))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=SOURCE / "build" / "bench",
                        help="the folder that is built, which is removed before")
    parser.add_argument("--report", type=pathlib.Path, metavar="BUILD",
                        help="build nothing: report what was built there")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--target", nargs="*", default=[], help="default: all")
    parser.add_argument("--option", action="append", default=[], metavar="-DNAME=VALUE",
                        help="an option of cmake, such as --option=-DENGRAM_UNITY=OFF")
    parser.add_argument("--top", type=int, default=20, help="sources that are listed")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    build = (options.report or options.build).resolve()
    if not options.report:
        if build.exists() and not (build / NOTES).exists() and any(build.iterdir()):
            parser.error(f"{build} is there, and was not made by this program")
        build_fresh(build, options.jobs, options.target, options.option)
    report = read_report(build, options.top)
    print(json.dumps(report, indent=2) if options.json else text_of(report))
    return 0


if __name__ == "__main__":
    sys.exit(main())
