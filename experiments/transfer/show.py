# SPDX-License-Identifier: Apache-2.0
"""Tables and bar charts of what `measure` found."""

from __future__ import annotations

import pathlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from experiments.paper import charts
from experiments.paper.measuring import Measuring
from experiments.paper.report import Figure, Section, Table, number, significant
from experiments.transfer.measure import OBJECTS

STEPS = {"commit": "ours", "query": "orange", "storage": "blue", "look-up": "sky",
         "conversion": "green"}
WAYS = {"direct": "grey", "relay": "blue", "memory, data told": "ours",
        "memory, IDs told, query": "orange"}
# How old its memory made data, over publish and subscribe.
PAPER_ROW, PAPER_OVER_RELAY = "the paper's memory", 2.1
TITLES = {"relay": "publish/subscribe"}


def show(measuring: Measuring, found: dict[str, list[dict[str, Any]]]) -> Section:
    section = Section("transfer", "Transfer: what the working memory takes")
    samples, entries = measuring.config["samples"], measuring.config["entries"]
    section.text(
        "The paper's three objects: <em>simple</em>, a number; <em>moderate</em>, a number, a text "
        "and a link; <em>complex</em>, 49 kB: an image, links, maps and an object in it. "
        f"Medians of {samples:,} samples; the memory holds {entries:,} other snapshots.")
    section.text(
        "Steps: a <em>commit</em> of one or more objects to a server in a process of its own, from "
        "the call to its acknowledgement; a <em>query</em> of the latest of all of them; what the "
        "server does in these, <em>storage</em> and <em>look-up</em>; and the <em>conversion</em> "
        "of an object to bytes and back.")
    section.blocks.append(_step_table(found["steps"]))
    section.blocks.append(Figure(
        "Time of each step by the number of objects in a commit; quartiles as whiskers. The "
        "axis of time is logarithmic.", _bars(measuring, "steps", found["steps"], STEPS,
                                               lambda row, name: row["steps"].get(name)),
        "Bars of the time of each step, by object and batch"))
    section.text(
        "Age of data: from the producer's call to the consumer that has the object in its hands, "
        "each in a process of its own, over gRPC on a local socket; all ways in turn, in one run. "
        "<em>Direct</em>: the producer calls the consumer. <em>Publish/subscribe</em>: through a "
        "process that passes bytes on. <em>Memory, data told</em>: through Engram's server, which "
        "stores it and tells the subscriber the data; <em>IDs told, query</em>: it tells what is "
        "new, and the consumer asks for it, as the paper's memory works.")
    section.blocks.append(_age_table(found["ages"]))
    section.blocks.append(Figure(
        "Age of data at the consumer, by the number of objects in a commit. Logarithmic.",
        _bars(measuring, "ages", found["ages"], WAYS,
              lambda row, name: {"median": row[name]} if name in row else None),
        "Bars of the age of data of each way, by object and batch"))
    return section


def _step_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    lines: list[list[str]] = []
    for name in OBJECTS:
        lines.append([name])
        lines += [[f"batch of {row['batch']}",
                   *[_us(row["steps"].get(step, {}).get("median")) for step in STEPS]]
                  for row in rows if row["object"] == name]
    return Table("Time of each step, median in microseconds.", ["", *STEPS], lines,
                 "A query's answer is decoded; storage and look-up are within one process, without "
                 "its transfer.")


def _age_table(rows: Sequence[Mapping[str, Any]]) -> Table:
    head = ["", *[TITLES.get(way, way) for way in WAYS], "told / direct", "told / pub/sub",
            "query / pub/sub"]
    lines = [[PAPER_ROW, *["–"] * (len(WAYS) + 2), number(PAPER_OVER_RELAY, 1)]]
    for name in OBJECTS:
        lines.append([name])
        for row in rows:
            if row["object"] == name:
                lines.append([f"batch of {row['batch']}", *[_us(row.get(way)) for way in WAYS],
                              _ratio(row, "memory, data told", "direct"),
                              _ratio(row, "memory, data told", "relay"),
                              _ratio(row, "memory, IDs told, query", "relay")])
    return Table("Age of data at the consumer, median in microseconds, and ratios in the same run.",
                 head, lines, "The paper's memory tells IDs, and consumers ask for the data.",
                 paper=[PAPER_ROW])


def _us(nanoseconds: float | None) -> str:
    return significant(None if nanoseconds is None else nanoseconds / 1e3)


def _ratio(row: Mapping[str, Any], way: str, other: str) -> str:
    return number(row[way] / row[other] if way in row else None)


def _bars(measuring: Measuring, name: str, rows: Sequence[Mapping[str, Any]],
          kinds: Mapping[str, str], value: Any) -> pathlib.Path:
    figure, axes = charts.panels(len(OBJECTS), 1, 4.1, 3.6)
    for axis, title in zip(axes[0], OBJECTS, strict=True):
        of_object = [row for row in rows if row["object"] == title]
        width = 0.8 / len(kinds)
        for i, (kind, colour) in enumerate(kinds.items()):
            found = [(x, one) for x, one in enumerate(value(row, kind) for row in of_object) if one]
            at = np.array([x for x, _ in found]) + (i - (len(kinds) - 1) / 2) * width
            medians = np.array([one["median"] for _, one in found]) / 1e3
            spread = None
            if found and "low" in found[0][1]:
                spread = [medians - np.array([one["low"] for _, one in found]) / 1e3,
                          np.array([one["high"] for _, one in found]) / 1e3 - medians]
            axis.bar(at, medians, width * 0.92, color=charts.COLOURS[colour], yerr=spread,
                     label=TITLES.get(kind, kind), error_kw={"lw": 0.8, "ecolor": "#333"})
        axis.set_xticks(range(len(of_object)), [str(row["batch"]) for row in of_object])
        if axis.patches:
            axis.set_yscale("log")
        axis.grid(axis="x", visible=False)
        axis.set_title(title)
        axis.set_xlabel("objects in a commit")
    axes[0, 0].set_ylabel("microseconds")
    limits = [axis.get_ylim() for axis in axes[0] if axis.patches]
    for axis in axes[0]:
        if limits:
            lowest = 10.0**np.floor(np.log10(min(low for low, _ in limits)))
            axis.set_ylim(lowest, max(high for _, high in limits))
        charts.format_values(axis.yaxis, lambda us: f"{us:,.10g}")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, ncol=len(kinds), loc="upper center", bbox_to_anchor=(0.5, 0))
    return charts.save(figure, measuring.folder / f"transfer-{name}.png")
