# SPDX-License-Identifier: Apache-2.0
"""Runs the program and the measurement programs, and keeps what was measured.

A result is kept beside what it was measured with; it is used again for as long as that is the same.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from typing import Any

ROOT = pathlib.Path(__file__).resolve().parents[2]


def arguments_of(description: str | None, name: str) -> argparse.Namespace:
    """The options that all experiments have."""
    parser = argparse.ArgumentParser(
        prog=f"python3 -m experiments.{name}", description=description,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    build = ROOT / "build"
    parser.add_argument("--engram", type=pathlib.Path, default=build / "release/bin/engram",
                        help="the program")
    parser.add_argument("--programs", type=pathlib.Path, default=build / "experiments",
                        help="folder of the measurement programs")
    parser.add_argument("--recordings", default="../shared/data",
                        help="folder of recordings; where it is missing a kitchen is simulated")
    parser.add_argument("--profile", choices=["full", "short"], default="full",
                        help="which part of config.json")
    parser.add_argument("--work", type=pathlib.Path, default=build / "paper",
                        help="folder of stores, results and plots")
    parser.add_argument("--again", action="store_true", help="measure anew what is known")
    parser.add_argument("--networks-from", type=pathlib.Path,
                        help="a result.json of the same experiment: what networks take is taken "
                             "from it, and only their rivals are measured")
    parser.add_argument("--keep", action="store_true",
                        help="put results and plots into experiments/NAME/results, too, but no "
                             "images of recordings")
    parser.add_argument("--minutes", type=float, default=float("inf"),
                        help="begin no measurement after so long; 0: only show what is known")
    return parser.parse_args()


def fingerprint(value: Any) -> str:
    """The same for equal JSON values."""
    text = json.dumps(value, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def file_fingerprint(path: pathlib.Path) -> str:
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while part := file.read(1 << 20):
            digest.update(part)
    return digest.hexdigest()[:16]


def sources() -> str:
    """The commit that is checked out, with a + where files differ from it."""
    done = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--exclude=*", "--dirty=+"],
                          text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
    return done.stdout.strip() or "unknown"


class Measuring:
    """One run of an experiment: its options, its configuration and its results.

    `results` is WORK/PROFILE/NAME.json: by name, what was measured with what, when, and how long
    it took.
    """

    def __init__(self, name: str, options: argparse.Namespace) -> None:
        self.name = name
        self.engram: pathlib.Path = options.engram.resolve()
        self.programs: pathlib.Path = options.programs.resolve()
        self.recordings = pathlib.Path(options.recordings) if options.recordings else None
        self.profile: str = options.profile
        self.folder: pathlib.Path = options.work.resolve() / options.profile
        self.folder.mkdir(parents=True, exist_ok=True)
        config = json.loads((ROOT / "experiments" / name / "config.json").read_text())
        self.config: dict[str, Any] = config[options.profile]
        self.deadline = time.monotonic() + 60 * options.minutes
        self.is_anew: bool = options.again
        self.networks_from: pathlib.Path | None = options.networks_from
        self.file = self.folder / f"{name}.json"
        self.results: dict[str, dict[str, Any]] = (
            json.loads(self.file.read_text()) if self.file.exists() else {})
        self.used: dict[str, dict[str, Any]] = {}
        self.skipped: list[str] = []

    def say(self, text: str) -> None:
        print(f"{self.name}: {text}", file=sys.stderr, flush=True)

    def measured(self, name: str, inputs: Mapping[str, Any], measure: Callable[[], Any],
                 files: Callable[[Any], list[str]] = lambda value: []) -> Any:
        """What `measure` returns, or returned with the same `inputs`; None: no time is left for it.

        `files`: those that a result names; where one is gone it is measured anew.
        """
        key = fingerprint(inputs)
        known = self.results.get(name)
        if known and known["key"] == key and (not self.is_anew or name in self.used) and all(
                pathlib.Path(file).exists() for file in files(known["value"])):
            self.used[name] = known
            return known["value"]
        if time.monotonic() >= self.deadline:
            self.skipped.append(name)
            return None
        self.say(name)
        began = time.monotonic()
        value = measure()
        self.results[name] = self.used[name] = {
            "key": key, "inputs": dict(inputs), "seconds": round(time.monotonic() - began, 1),
            "measured": time.strftime("%Y-%m-%d %H:%M"), "sources": sources(), "value": value}
        new = self.file.with_suffix(".new")
        new.write_text(json.dumps(self.results, indent=1) + "\n")
        new.replace(self.file)
        return value

    def earlier(self, case: Mapping[str, Any]) -> dict[str, Any] | None:
        """What `networks_from` says of the case with these members; None: it is to be measured."""
        if self.networks_from is None:
            return None
        found = json.loads(self.networks_from.read_text())["found"]
        same: list[dict[str, Any]] = [one for one in found
                                      if all(one[key] == value for key, value in case.items())]
        if not same:
            sys.exit(f"{self.name}: '{self.networks_from}' has no {dict(case)}")
        return same[0]

    def run(self, *arguments: object) -> str:
        """What the program `engram` printed; its progress stays on stderr."""
        return self._run([self.engram, *arguments])

    def report(self, *arguments: object) -> Any:
        return json.loads(self.run(*arguments, "--json"))

    def program(self, path: str, *arguments: object, may_miss: bool = False) -> Any:
        """The JSON file that a measurement program wrote. `may_miss`: it may exit with 1, as those
        do that have bars to reach."""
        file = self.folder / f"program-{os.getpid()}.json"
        file.unlink(missing_ok=True)
        try:
            self._run([self.programs / path, *arguments, "--json", file],
                      codes=(0, 1) if may_miss else (0,))
            return json.loads(file.read_text())
        finally:
            file.unlink(missing_ok=True)

    def _run(self, words: list[object], codes: tuple[int, ...] = (0,)) -> str:
        texts = [str(word) for word in words]
        print("$ " + " ".join([pathlib.Path(texts[0]).name, *texts[1:]]), file=sys.stderr,
              flush=True)
        done = subprocess.run(texts, stdout=subprocess.PIPE, text=True, check=False)
        if done.returncode not in codes:
            sys.exit(f"{self.name}: {' '.join(texts)} ended with {done.returncode}")
        return done.stdout

    def version(self) -> str:
        return subprocess.run([self.engram, "--version"], stdout=subprocess.PIPE, text=True,
                              check=True).stdout.strip()
