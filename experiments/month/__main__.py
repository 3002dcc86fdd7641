# SPDX-License-Identifier: Apache-2.0
"""A month of nights: does a memory stay small, quick and true while its robot lives on?

Thirty days of a simulated kitchen are recorded into two stores, and each night both are
consolidated with `--drop-raw --grace 2d`: one as `--representation auto`, one as video alone. The
light drifts, rooms change, the camera is moved, a day is ten times as long, and nights are killed,
cut short, and find the disk full. After every night a fresh process reads everything and compares
it with what was recorded. What must hold is listed in experiments/README.md.

A month that is stopped (Ctrl-C) or killed goes on at the night where it was; --anew begins again.
"""
from __future__ import annotations

import argparse
import json
import pathlib
import shutil
import signal
import sys
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import replace
from typing import Any

from experiments.month import checks, days, nights, program, report

ROOT = pathlib.Path(__file__).resolve().parents[2]
STORES = ("auto", "video")
EXAMPLES = """Examples:
  python3 -m experiments.month                            30 nights of 300 images, up to 3 hours
  python3 -m experiments.month --form short --work /tmp/month    11 nights of 40 images, minutes
  python3 -m experiments.month --nights 12 --json month.json     the first twelve
  python3 -m experiments.month --show                     what is known of a month that goes on

Exit code: 0 where every check held (or those of --checks), 1 where one did not or something failed,
130 after Ctrl-C.
"""


def arguments_of(words: list[str] | None = None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python3 -m experiments.month", description=__doc__,
                                     epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--engram", type=pathlib.Path, default=ROOT / "build/release/bin/engram",
                        help="the program (build/release/bin/engram); PYTHONPATH has its package")
    parser.add_argument("--form", choices=list(days.PLANS), default="full",
                        help="full: 30 nights; short: the same happenings in 11 small ones; test: "
                             "in 9 of half the images (full)")
    parser.add_argument("--nights", type=int, help="only the first NIGHTS nights (all of the form)")
    parser.add_argument("--images", type=int,
                        help="images of a usual day (300; short: 40; test: 20)")
    parser.add_argument("--steps", type=int,
                        help="steps of training in a night (300; short: 30; test: 10)")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/month",
                        help="folder of stores, raw data and results (build/month)")
    parser.add_argument("--json", type=pathlib.Path, help="all figures (WORK/month-FORM.json)")
    parser.add_argument("--anew", action="store_true", help="forget a month that was begun")
    parser.add_argument("--show", action="store_true", help="only show what is known")
    parser.add_argument("--checks", type=int, nargs="+", choices=range(len(checks.CHECKS)),
                        metavar="NUMBER",
                        help="the checks that have to hold for exit code 0 (all that the nights "
                             "suffice for)")
    options = parser.parse_args(words)
    if not options.engram.exists():
        parser.error(f"--engram: '{options.engram}': no such program")
    for name, minimum in (("nights", 1), ("images", 16), ("steps", 1)):
        value = getattr(options, name)
        if value is not None and value < minimum:
            parser.error(f"--{name}: found {value}, needs {minimum} or more")
    return options


def plan_of(options: argparse.Namespace) -> days.Plan:
    plan = days.PLANS[options.form]
    if options.images:
        plan = replace(plan, images=options.images)
    return replace(plan, steps=options.steps) if options.steps else plan


def tell(text: str) -> None:
    print(f"month: {text}", file=sys.stderr, flush=True)


def time_text(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min"


class Month:
    """A month that goes on from night to night.

    WORK/FORM/NN has both stores after night NN, what was read of them, and the figures of all
    nights until then. A night works in NN.part, which gets its name when it is done: a month that
    is killed loses no more than a night.
    """

    def __init__(self, options: argparse.Namespace) -> None:
        self.plan = plan_of(options)
        self.engram = options.engram.resolve()
        self.folder = options.work.resolve() / options.form
        self.raw = self.folder / "raw"
        self.faults = self.folder / "libfaulty_files.so"
        self.end = min(options.nights or self.plan.nights, self.plan.nights)
        if options.anew:
            shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True, exist_ok=True)
        self._keep_plan()
        self.done = max((int(one.name) for one in self.folder.iterdir()
                         if one.is_dir() and one.name.isdigit()), default=0)
        self.figures: checks.Figures = (
            json.loads((self.night_folder(self.done) / "figures.json").read_text())
            if self.done else [])

    def _keep_plan(self) -> None:
        """Refuses to go on with a month of another plan."""
        file, text = self.folder / "plan.txt", f"{self.plan}\n"
        if file.exists() and file.read_text() != text:
            raise program.Failed(f"'{self.folder}' has a month of another plan, needs --anew or "
                                 "another --work")
        file.write_text(text)

    def night_folder(self, number: int) -> pathlib.Path:
        return pathlib.Path(self.folder / f"{number:02}")

    def usual_seconds(self, store: str) -> float:
        """What a usual night took lately; 0: there was none yet."""
        took = sorted(night["stores"][store]["job"]["seconds"] for night in self.figures
                      if night["night"] > 1 and self.plan.is_usual(night["night"]))
        return float(took[len(took) // 2]) if took else 0

    def live(self) -> None:
        """Passes all nights that are left."""
        self.raw.mkdir(exist_ok=True)
        if not self.faults.exists():
            program.build_faulty_files(ROOT / "tests/faults/faulty_files.c", self.faults)
        if self.done:
            tell(f"goes on after night {self.done}")
        began, first = time.monotonic(), self.done + 1
        for number in range(first, self.end + 1):
            self.make_raw(number)
            self.live_through(number)
            self.tell_progress(number, time.monotonic() - began, first)

    def make_raw(self, number: int) -> None:
        room = self.plan.room_of(number)
        if not days.file_of(self.raw, number).exists():
            tell(f"draws room {self.plan.rooms[room]}: "
                 f"{days.drawn_seconds(self.plan, room):.0f} s at {days.DRAWN_HZ} Hz")
        days.make_days(self.plan, room, self.raw, self.draw)

    def draw(self, store: pathlib.Path, seed: int, seconds: float) -> None:
        begin = "2026-01-01T00:00:00Z"
        program.needs(program.run(
            [self.engram, "simulate", "kitchen", store, "--fast", "--seed", seed, "--seconds",
             f"{seconds:.2f}", "--start", begin, "--progress", "none"]), "engram simulate kitchen")

    def live_through(self, number: int) -> None:
        folder = self.folder / f"{number:02}.part"
        shutil.rmtree(folder, ignore_errors=True)
        if self.done:
            shutil.copytree(self.night_folder(self.done), folder)
        else:
            folder.mkdir()
        happenings = ", ".join(self.plan.happenings(number))
        tell(f"night {number} of {self.end}{': ' + happenings if happenings else ''}")
        stores = self.pass_together(number, folder)
        self.figures.append({"night": number, "happenings": self.plan.happenings(number),
                             "stores": stores})
        (folder / "figures.json").write_text(json.dumps(self.figures, indent=1) + "\n")
        folder.rename(self.night_folder(number))
        if self.done:
            shutil.rmtree(self.night_folder(self.done))
        self.done = number

    def pass_together(self, number: int, folder: pathlib.Path) -> dict[str, dict[str, Any]]:
        """Lets all stores pass a night at once. Where one fails, the others are stopped."""
        try:
            with ThreadPoolExecutor(len(STORES)) as pool:
                passing = [pool.submit(nights.pass_night, nights.Night(
                    self.plan, number, self.engram, self.raw, self.faults, folder, name,
                    self.usual_seconds(name))) for name in STORES]
                try:
                    # The first that fails says why: the others fail because they are stopped.
                    for one in as_completed(passing):
                        one.result()
                except BaseException:
                    program.stop_all()
                    raise
                return {name: one.result() for name, one in zip(STORES, passing, strict=True)}
        finally:
            program.start_again()

    def tell_progress(self, number: int, spent: float, first: int) -> None:
        images = [self.plan.images_of(day) for day in range(1, self.end + 1)]
        each = spent / sum(images[first - 1 : number])
        job = {name: one["job"]["processor_seconds"]
               for name, one in self.figures[-1]["stores"].items()}
        costs = ", ".join(f"{name} {seconds:.0f} s" for name, seconds in job.items())
        tell(f"night {number}: {costs} of processor time; {time_text(spent)} so far, about "
             f"{time_text(each * sum(images[number:]))} left")


def show(month: Month, options: argparse.Namespace) -> bool:
    """Prints and writes what is known. Returns whether nothing was missed."""
    if not month.figures:
        print("nothing is known yet")
        return False
    about = {"form": options.form, "program": program.needs(
        program.run([month.engram, "--version"]), "engram --version").out.strip()}
    report.write_json(month.plan, month.figures,
                      options.json or options.work / f"month-{options.form}.json", about)
    picture = options.work / f"month-{options.form}.png"
    report.draw(month.plan, month.figures, picture)
    verdicts = checks.judge(month.plan, month.figures)
    print(f"{report.night_table(month.plan, month.figures)}\n")
    print("\n".join(report.verdict_lines(verdicts)))
    tell(f"wrote {picture}")
    if options.checks:
        return all(one.held is True for one in verdicts if one.number in options.checks)
    return all(one.held is not False for one in verdicts)


def stop(*_: Any) -> None:
    """Stops the month as Ctrl-C does, which a program in the background may ignore."""
    raise KeyboardInterrupt


def main() -> int:
    signal.signal(signal.SIGTERM, stop)
    options = arguments_of()
    try:
        month = Month(options)
        try:
            if not options.show:
                month.live()
        except KeyboardInterrupt:
            tell(f"stopped after night {month.done}; the same command goes on")
            show(month, options)
            return 130
        return 0 if show(month, options) else 1
    except program.Failed as failed:
        tell(str(failed))
        return 1


if __name__ == "__main__":
    sys.exit(main())
