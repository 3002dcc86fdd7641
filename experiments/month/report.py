# SPDX-License-Identifier: Apache-2.0
"""What is shown of a month: a table, a picture, and a line for each check."""
from __future__ import annotations

import json
import pathlib
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from experiments.month import checks, days

MAX_SHOWN = 12  # Places where a check did not hold, on the terminal; the JSON file has all.


def table(rows: Sequence[Sequence[str]]) -> str:
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(row, widths)).rstrip()
                     for row in rows)


def percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.1f}"


def bytes_an_image(store: dict[str, Any]) -> float | None:
    """Latents and models, for each image whose latents are there."""
    camera = store["read"][days.CAMERA]
    encoded: int = camera["images"] - camera["waiting"]
    sizes = store["sizes"]
    return (sizes["latent_bytes"] + sizes["model_bytes"]) / encoded if encoded else None


def night_table(plan: days.Plan, figures: checks.Figures) -> str:
    rows = [["night", "store", "new", "processor", "memory", "bytes/image", "of video",
             "images of video", "models",
             "min PSNR", "within images", "joints", "waits", ""]]
    for night in figures:
        for name, store in night["stores"].items():
            camera, each = store["read"][days.CAMERA], bytes_an_image(store)
            worst_db = camera["min_psnr_db"]
            rows.append(
                [str(night["night"]), name, str(store["recorded"]["kept"]),
                 f"{store['job']['processor_seconds']:.1f} s",
                 f"{store['job']['megabytes']:.0f} MB", "-" if each is None else f"{each:.0f}",
                 *(f"{ratio:.4f}" if name == "auto" and ratio else ""
                   for ratio in (checks.bytes_ratio(night), checks.images_ratio(night))),
                 "+".join(str(count) for count in store["sizes"]["models"].values()) or "0",
                 "-" if worst_db is None else f"{worst_db:.2f} dB",
                 *(percent(checks.within_share(store["predicted"][entity]))
                   for entity in (days.CAMERA, days.JOINTS)),
                 str(checks.waiting_in(store)), ", ".join(plan.happenings(night["night"]))])
    return table(rows)


def verdict_lines(verdicts: Sequence[checks.Verdict]) -> list[str]:
    lines = []
    for one in verdicts:
        lines.append(f"{one.number}  {one.word:<6}  {one.name}: {one.found}")
        lines += [f"           {where}" for where in one.missed[:MAX_SHOWN]]
        if len(one.missed) > MAX_SHOWN:
            lines.append(f"           and {len(one.missed) - MAX_SHOWN} more")
    return lines


def write_json(plan: days.Plan, figures: checks.Figures, file: pathlib.Path, about: Any) -> None:
    verdicts = [asdict(one) for one in checks.judge(plan, figures)]
    file.write_text(json.dumps({**about, "plan": asdict(plan), "checks": verdicts,
                                "nights": figures}, indent=1) + "\n")


def draw(plan: days.Plan, figures: checks.Figures, file: pathlib.Path) -> None:
    """Bytes, processor time, models and coverage of every night."""
    from experiments.paper import charts

    colours = {"auto": charts.OURS, "video": charts.COLOURS["blue"]}
    numbers = [night["night"] for night in figures]
    figure, ((sizes, costs), (models, shares)) = charts.panels(2, 2, width=5.6)
    for name, colour in colours.items():
        stores = [night["stores"][name] for night in figures]
        style = {"color": colour, "marker": ".", "linewidth": 1.2, "label": name}
        sizes.plot(numbers, [bytes_an_image(store) or float("nan") for store in stores], **style)
        costs.plot(numbers, [store["job"]["processor_seconds"] for store in stores], **style)
        models.step(numbers, [max(store["sizes"]["models"].values(), default=0)
                              for store in stores], where="mid", color=colour, label=name,
                    linestyle="-" if name == "auto" else "--")
    models.step(numbers, [1 + plan.changes_until(number) for number in numbers], where="mid",
                color=charts.COLOURS["grey"], linestyle=":", label="allowed")
    shares.axhspan(100 * checks.MIN_WITHIN, 100 * checks.MAX_WITHIN,
                   color=charts.COLOURS["green"], alpha=0.15, label="wanted")
    for entity, label, colour in ((days.CAMERA, "images", charts.OURS),
                                  (days.JOINTS, "joints", charts.COLOURS["purple"])):
        found = [checks.within_share(night["stores"]["auto"]["predicted"][entity])
                 for night in figures]
        shares.plot(numbers, [float("nan") if share is None else 100 * share for share in found],
                    color=colour, marker=".", linewidth=1.2, label=f"{label}, auto")
    titles = {sizes: "Latents and models, bytes an image", costs: "Processor time of the job, s",
              models: "Max models of an entity", shares: "Bounds of the next day that held, %"}
    for axis, title in titles.items():
        axis.set_title(title)
        axis.set_xlabel("night")
        axis.set_xlim(0.5, max(plan.nights, numbers[-1]) + 0.5)
        axis.legend(loc={sizes: "upper right", models: "upper left"}.get(axis, "lower right"))
    for axis in (sizes, models):
        axis.set_ylim(bottom=0)
    costs.set_yscale("log")
    costs.set_ylim(top=8 * max(store["job"]["processor_seconds"] for night in figures
                               for store in night["stores"].values()))  # Room for words.
    shares.set_ylim(top=101)
    for number in numbers:
        told = ", ".join(plan.happenings(number))
        if told:
            for axis in titles:
                axis.axvline(number, color=charts.COLOURS["grey"], linewidth=0.5, alpha=0.5)
            costs.text(number, 0.98, told, rotation=90, fontsize=6.5, va="top", ha="right",
                       color=charts.COLOURS["grey"], transform=costs.get_xaxis_transform())
    charts.save(figure, file)
