# SPDX-License-Identifier: Apache-2.0
"""Runs the measurement programs of `experiments/server`: one object and batch at a time."""

from __future__ import annotations

from typing import Any

from experiments.paper.measuring import Measuring, file_fingerprint

OBJECTS = ("simple", "moderate", "complex")


def measure(measuring: Measuring) -> dict[str, list[dict[str, Any]]]:
    """Nanoseconds of each step, and of each way's age of data, by object and batch."""
    config = measuring.config
    words = ["--samples", config["samples"], "--warm-up", config["warm_up"], "--entries",
             config["entries"], "--rounds", config["rounds"]]
    found: dict[str, list[dict[str, Any]]] = {"steps": [], "ages": []}
    for batch in config["batches"]:
        steps = _measured(measuring, "step_bars", f"steps, batch {batch}",
                          [*words, "--batches", batch])
        found["steps"] += steps["steps_ns"] if steps else _missing(batch)
    for name in OBJECTS:
        for batch in config["batches"]:
            ages = _measured(measuring, "age_bars", f"age, {name}, batch {batch}", [
                *words, "--batches", batch, "--objects", name, "--no-subscribers"])
            found["ages"] += ages["ages_ns"] if ages else [{"object": name, "batch": batch}]
    return found


def _missing(batch: int) -> list[dict[str, Any]]:
    return [{"object": name, "batch": batch, "steps": {}} for name in OBJECTS]


def _measured(measuring: Measuring, program: str, what: str, words: list[object]) -> Any:
    path = f"server/{program}"
    inputs = {"program": file_fingerprint(measuring.programs / path),
              "words": [str(word) for word in words]}
    return measuring.measured(what, inputs,
                              lambda: measuring.program(path, *words, may_miss=True))
