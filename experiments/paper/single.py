# SPDX-License-Identifier: Apache-2.0
"""One experiment: measures, and writes its JSON, its plots and its part of the report."""

from __future__ import annotations

import argparse
import json
import pathlib
import platform
import shutil
import signal
import sys
import time
from collections.abc import Callable
from typing import Any

from experiments.paper.measuring import ROOT, Measuring, arguments_of, file_fingerprint
from experiments.paper.report import Figure, Section, write_page

Measure = Callable[[Measuring], Any]
Show = Callable[[Measuring, Any], Section]


def run_one(name: str, options: argparse.Namespace, measure: Measure,
            show: Show) -> tuple[Measuring, Section]:
    # What is run ends with this: an exception stops a process that is waited for.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    measuring = Measuring(name, options)
    found = measure(measuring)
    section = show(measuring, found)
    summary = measuring.folder / f"{name}-result.json"
    earlier = _earlier(measuring)
    text = json.dumps(
        {"experiment": name, "profile": measuring.profile, "program": measuring.version(),
         "configuration": measuring.config, **earlier, "not_run": measuring.skipped,
         "found": found}, indent=1)
    summary.write_text(text.replace(f"{measuring.folder}/", "") + "\n")
    if options.keep:
        _keep(measuring, section, summary)
    if measuring.skipped:
        measuring.say(f"{len(measuring.skipped)} measurements were not run: no time was left")
    return measuring, section


def _earlier(measuring: Measuring) -> dict[str, Any]:
    """Names the result that figures of networks are from, if they are of an earlier run."""
    file = measuring.networks_from
    if file is None:
        return {}
    first = json.loads(file.read_text()).get("networks_from", file_fingerprint(file))
    return {"networks_from": first}


def _keep(measuring: Measuring, section: Section, summary: pathlib.Path) -> None:
    """Pictures of networks of an earlier run are not drawn again: they stay as they are."""
    folder = ROOT / "experiments" / measuring.name / "results"
    if measuring.networks_from is None:
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(exist_ok=True)
    shutil.copy(summary, folder / "result.json")
    for block in section.blocks:
        if isinstance(block, Figure) and not block.is_recorded:
            shutil.copy(block.file, folder / block.file.name.removeprefix(f"{measuring.name}-"))


def run_single(name: str, about: str | None, measure: Measure, show: Show) -> None:
    options = arguments_of(about, name)
    measuring, section = run_one(name, options, measure, show)
    page = measuring.folder / f"{name}.html"
    write_page(page, section.title, facts([measuring]), [section])
    measuring.say(f"wrote {page}")


def facts(runs: list[Measuring]) -> str:
    """Where, when and with what it was measured, as HTML."""
    commits = sorted({one.get("sources", "unknown") for run in runs for one in run.used.values()})
    dates = sorted(one["measured"] for run in runs for one in run.used.values())
    spent = sum(one["seconds"] for run in runs for one in run.used.values())
    missing = sum(len(run.skipped) for run in runs)
    span = f"measured {dates[0]} to {dates[-1]}" if dates else "nothing was measured"
    text = (f"Profile <b>{runs[0].profile}</b>; {span}, {spent / 60:.0f} minutes in all; "
            f"{runs[0].version()}, sources at {', '.join(commits) or 'unknown'}; {_machine()}; "
            f"written {time.strftime('%Y-%m-%d %H:%M')}.")
    if missing:
        text += f" {missing} measurements were not run; their cells say so."
    return f'<p class="facts">{text}</p>'


def _machine() -> str:
    model = "unknown processor"
    with open("/proc/cpuinfo", encoding="ascii", errors="replace") as lines:
        for line in lines:
            if line.startswith("model name"):
                model = line.split(":", 1)[1].strip()
                break
    import os

    return f"{os.cpu_count()} cores of {model}, {platform.system()} {platform.release()}"
