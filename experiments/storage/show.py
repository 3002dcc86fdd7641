# SPDX-License-Identifier: Apache-2.0
"""Tables and plots of what `measure` found."""

from __future__ import annotations

import math
import pathlib
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from experiments.paper import charts, quality
from experiments.paper.measuring import Measuring
from experiments.paper.recordings import CAMERA, RATE_HZ
from experiments.paper.report import Figure, Section, Table, number, significant
from experiments.storage.measure import choices

# Of the paper's robot, all of its sensors together.
PAPER_RAW_MB_PER_SECOND = 35.665
REFERENCE = "H.265"
COLOURS = {"H.264": "orange", "H.265": "blue", "AV1": "green"}


def show(measuring: Measuring, cases: list[dict[str, Any]]) -> Section:
    section = Section("storage", "Storage: from the robot to the night")
    section.text(
        "What a second of recording takes in each stage: as the robot offers it at the full rate; "
        f"what the filter keeps ({RATE_HZ} Hz); after the online codec, in the segments of the "
        "store; and after the night, as latents of a model that was trained on these recordings, "
        "with the model counted. Megabytes are 10<sup>6</sup> bytes.")
    section.blocks.append(_stage_table(measuring, cases))
    section.text(
        "The same images through what one would pick instead: video encoders of FFmpeg at their "
        "archival settings, tuned for PSNR, 10 bits inside. Bytes of codecs are those of the bare "
        "stream without its settings; ours are coded blocks with their checksums, alone and with "
        "the model.")
    file = _curves(measuring, cases)
    section.blocks.append(Figure(
        "Bytes of an image against quality (mean of the images' PSNR). Solid: one key frame for "
        "the whole recording. Dashed: a key frame every 16 images, which gives the same random "
        "access as our chains of 16. Red dotted: ours with the model divided by the images of this "
        "recording alone. The diamond keeps a bound in <em>every</em> image (<code>--representation "
        "auto</code>).", file, "Curves of bytes per image against PSNR"))
    section.blocks.append(_equal_table(cases))
    section.blocks.append(_bd_table(measuring, cases))
    grid = _samples(measuring, cases)
    if grid:
        section.blocks.append(grid)
    return section


def seconds_of(case: dict[str, Any]) -> float:
    return float(case["stages"]["seconds"])


def _stage_table(measuring: Measuring, cases: list[dict[str, Any]]) -> Table:
    head = ["stage", "images MB/s", "numbers MB/s", "both MB/s", "% of offered", "PSNR mean / least",
            "recipe"]
    rows: list[list[str]] = [
        ["the paper's robot, offered", "–", "–", number(PAPER_RAW_MB_PER_SECOND, 3), "100", "–",
         "two cameras 640 x 480 and all else that its memory gets"]]
    for case in cases:
        if case["stages"] is None:
            continue
        about = case["stages"]
        rows.append([f"{case['title']}, {case['side']} x {case['side']}: {about['frames']} images "
                     f"in {about['seconds']:.0f} s"])
        rows += [_stage_row(case, *stage) for stage in _stages(measuring, case)]
    return Table(
        "Megabytes per second of recording, by stage.", head, rows,
        "Numbers are joints and poses; offline they are kept within 0.005 standard deviations of "
        "each, or 1 mrad. “with the model” charges all of it to this recording; the line "
        f"below it to {measuring.config['retention_hours']} hours of the same. Segment bytes are "
        "those of the HDF5 files. The manifest, which names segments and models, takes "
        + ", ".join(f"{c['stages']['manifest_bytes']:,} B ({c['dataset']}, {c['side']})"
                    for c in cases if c["stages"])
        + " in all.", paper=["the paper's robot, offered"])


def _stages(measuring: Measuring, case: dict[str, Any]) -> list[tuple[Any, ...]]:
    """(name, bytes of images, bytes of numbers, dB, recipe)"""
    entities = case["stages"]["entities"]
    camera = entities[CAMERA]
    others = [one for name, one in entities.items() if name != CAMERA]

    def of_numbers(kind: str) -> int:
        return sum(one[kind] for one in others)

    stages: list[tuple[Any, ...]] = [
        ("offered", camera["offered"], of_numbers("offered"), "lossless", "all that comes"),
        ("kept by the filter", camera["kept"], of_numbers("kept"), "lossless",
         f"frequency: {RATE_HZ} Hz"),
        ("online, stored", camera["stored"], of_numbers("stored"), "lossless",
         ", ".join(camera["codecs"]) or "plain")]
    numbers = case["numbers"] and case["numbers"]["entities"].values()
    latent = None if numbers is None else sum(one["latent"] for one in numbers)
    model = None if numbers is None else sum(one["model"] for one in numbers)
    with_model = None if latent is None else latent + model
    share = seconds_of(case) / (3600 * measuring.config["retention_hours"])
    shared = None if latent is None else latent + share * model
    points = [(f"offline, latents at {asked['psnr']} dB", found, asked, "latents")
              for asked, found in zip(case["targets"], case["latents"], strict=True)]
    if case["auto_db"]:
        found = case["auto"]
        asked = {"psnr": case["auto_db"], "budget": found["budget"] if found else ""}
        points.append((f"offline, every image at {case['auto_db']} dB", found, asked, "auto"))
    for name, found, asked, form in points:
        if found is None:
            stages += [(name, None, latent, None, "")]
            continue
        quality_text = f"{number(found['psnr_db'])} / {number(found['minimum_db'])}"
        options = " ".join(map(str, choices(measuring.config, asked, form)))
        recipe = f"<code>engram consolidate {options}</code>"
        segment, own = found["segment_bytes"], found["model_bytes"]
        kept = "" if form == "latents" else f"; kept {forms_of(found)}"
        stages.append((name, segment, latent, quality_text, recipe + kept))
        stages.append(("&emsp;with the model", segment + own, with_model, "", f"{own:,} B of models"
                       + ("" if found["has_networks"] else ", none for images")))
        stages.append((f"&emsp;with its share in {measuring.config['retention_hours']} h",
                       segment + share * own, shared, "", ""))
    return stages


def forms_of(found: dict[str, Any]) -> str:
    """What images were kept as: "304 of 304 images as AV1, no network"."""
    rows = found["images"]
    forms = {"latents": "latent_rows", "refined latents": "refined_rows",
             "latents with a residual": "residual_rows", "AV1": "video_rows",
             "FFV1": "lossless_rows"}
    text = ", ".join(f"{rows[member]:,} of {rows['rows']:,} images as {form}"
                     for form, member in forms.items() if rows[member])
    return text + ("" if found["has_networks"] else ", no network")


def _stage_row(case: dict[str, Any], name: str, images: float | None, numbers: float | None,
               psnr: str | None, recipe: str) -> list[str]:
    entities = case["stages"]["entities"].values()
    offered = sum(one["offered"] for one in entities)
    both = None if images is None or numbers is None else images + numbers

    def rate(size: float | None) -> str:
        return significant(None if size is None else size / 1e6 / seconds_of(case))

    percent = None if both is None else 100 * both / offered
    return [name, rate(images), rate(numbers), rate(both), significant(percent),
            number(None) if psnr is None else psnr, recipe]


def codec_points(curve: dict[str, Any]) -> list[tuple[float, float]]:
    return [(one["bytes"], one["psnr_db"]) for one in curve["points"] if one]


def our_points(case: dict[str, Any], hours: float | None) -> list[tuple[float, float]]:
    """(bytes of an image, dB); `hours`: what the model is divided by; 0: by this recording; None:
    it is not counted."""
    points = []
    for one in case["latents"]:
        if one is None:
            continue
        images = case["stages"]["frames"]
        if hours:
            images = hours * 3600 * case["stages"]["frames"] / seconds_of(case)
        model = 0 if hours is None else one["model_bytes"] / images
        points.append((one["bytes"] + model, one["psnr_db"]))
    return sorted(points)


def _short(title: str) -> str:
    return title.split(" ")[0]


def _curves(measuring: Measuring, cases: list[dict[str, Any]]) -> pathlib.Path:
    names = list(dict.fromkeys(case["dataset"] for case in cases))
    columns = max(sum(case["dataset"] == name for case in cases) for name in names)
    figure, axes = charts.panels(columns, len(names), 4.6, 3.5)
    for axis in axes.flat:
        axis.set_visible(False)
    for y, name in enumerate(names):
        for x, case in enumerate(one for one in cases if one["dataset"] == name):
            axis = axes[y, x]
            axis.set_visible(True)
            _draw_case(axis, case)
            axis.set_title(f"{name}, {case['side']} x {case['side']}")
            axis.set_xlabel("bytes per image")
            axis.set_ylabel("mean PSNR, dB")
    known = {label: handle for axis in axes.flat if axis.get_visible()
             for handle, label in zip(*axis.get_legend_handles_labels(), strict=True)}
    figure.legend(known.values(), known, ncol=3, loc="upper center", bbox_to_anchor=(0.5, 0))
    return charts.save(figure, measuring.folder / "storage-curves.png")


def _draw_case(axis: Any, case: dict[str, Any]) -> None:
    for curve in case["codecs"]:
        points = codec_points(curve)
        if points:
            axis.plot(*zip(*sorted(points)), color=charts.COLOURS[COLOURS[_short(curve["title"])]],
                      ls="--" if curve["group"] else "-", lw=1.3, marker=".",
                      label=None if curve["group"] else curve["title"])
    for hours, style, label in ((None, "-", "ours, latents"), (0, ":", "ours with the model")):
        points = our_points(case, hours)
        if points:
            axis.plot(*zip(*points), color=charts.OURS, ls=style, lw=2, marker="o", ms=4.5,
                      mfc=charts.OURS if hours is None else "white", label=label)
    if case["auto"]:
        one = case["auto"]
        model = one["model_bytes"] / case["stages"]["frames"] if one["has_networks"] else 0
        axis.plot([one["bytes"] + model], [one["psnr_db"]], "D", color=charts.COLOURS["purple"],
                  ms=6, label="ours, every image bounded" + (
                      "" if one["has_networks"] else ": all of it AV1, no network"))
    axis.set_xscale("log")
    charts.format_values(axis.xaxis, lambda size: f"{size:,.0f}")


def at_bytes(points: list[tuple[float, float]], size: float) -> float:
    """The quality of a curve at so many bytes, between its points; NaN outside of them."""
    best = dict(sorted(points))
    if len(best) < 2 or not min(best) <= size <= max(best):
        return math.nan
    logs = [math.log(one) for one in best]
    return float(PchipInterpolator(logs, list(best.values()))(math.log(size)))


def _without_network(found: dict[str, Any] | None) -> str:
    return " (no network)" if found and not found["has_networks"] else ""


def _equal_table(cases: list[dict[str, Any]]) -> Table:
    curves = list(dict.fromkeys((one["title"], one["group"]) for case in cases
                                for one in case["codecs"]))
    head = ["images", "B each", "ours dB", "ours SSIM",
            *[f"{_short(title)} dB{', keys' if group else ''}" for title, group in curves]]
    rows: list[list[str]] = []
    for case in cases:
        found = [(f"{case['dataset']}, {case['side']}, latents at {asked['psnr']}", one)
                 for asked, one in zip(case["targets"], case["latents"], strict=True)]
        if case["auto_db"]:
            found.append((f"{case['dataset']}, {case['side']}, all at {case['auto_db']}"
                          + _without_network(case["auto"]), case["auto"]))
        for name, one in found:
            row = [name]
            if one is None:
                rows.append(row + [number(None)] * (len(head) - 1))
                continue
            row += [significant(one["bytes"]), number(one["psnr_db"]), number(one["ssim"], 4)]
            for title, group in curves:
                same = [curve for curve in case["codecs"]
                        if (curve["title"], curve["group"]) == (title, group)]
                row.append(number(at_bytes(codec_points(same[0]), one["bytes"])) if same else "–")
            rows.append(row)
    return Table(
        "Quality at equal bytes: mean PSNR of codecs where they spend what ours do (model not "
        "counted), interpolated between measured points.", head, rows,
        "“keys”: a key frame every 16 images. “–”: outside of what was measured. PSNR and SSIM are "
        "scikit-image's.")


def _bd_table(measuring: Measuring, cases: list[dict[str, Any]]) -> Table:
    hours = measuring.config["retention_hours"]
    head = ["curve", *[f"{case['dataset']}, {case['side']}" for case in cases]]
    rows: dict[str, list[str]] = {}
    for column, case in enumerate(cases):
        reference: list[tuple[float, float]] = next((codec_points(one) for one in case["codecs"]
                          if one["title"].startswith(REFERENCE) and not one["group"]), [])
        curves = {f"{one['title']}{', keys' if one['group'] else ''}": codec_points(one)
                  for one in case["codecs"]}
        curves["ours, model not counted"] = our_points(case, None)
        curves[f"ours, its share in {hours} h"] = our_points(case, hours)
        curves["ours, all of the model"] = our_points(case, 0)
        is_known = {name: len(points) > 0 for name, points in curves.items()}
        for name, points in curves.items():
            rate = quality.bd_rate(reference, points)
            cell = number(None) if not is_known[name] else (
                "–" if rate is None else f"{number(100 * rate, 1, sign=True)} %")
            rows.setdefault(name, ["–"] * len(cases))[column] = cell
    return Table(
        "BD-rate: bytes at equal PSNR against H.265 with one key frame, on average over the "
        "qualities that both curves have. Negative: fewer bytes.", head,
        [[name, *cells] for name, cells in rows.items()],
        "Curves of ours have two or three points, each trained for the minutes in "
        "<code>config.json</code>: the rates say how they lie, not the last percent. “–”: no "
        "common qualities.")


def _samples(measuring: Measuring, cases: list[dict[str, Any]]) -> Figure | None:
    """One image, as every codec shows it at about our bytes."""
    from experiments.paper import video_coders
    from experiments.storage.measure import images_of

    rows, labels, below = [], [], []
    titles = ["recorded"]
    for case in cases:
        known = [one for one in case["latents"] if one and pathlib.Path(one["store"]).exists()]
        if not known or not case["codecs"]:
            continue
        ours = known[len(known) // 2]
        recorded = images_of(pathlib.Path(case["frames"]), "recorded")
        at = len(recorded) // 2
        shown = images_of(pathlib.Path(ours["store"]), "latent")[at]
        row, texts = [recorded[at], shown], ["", _line(ours["bytes"], recorded[at], shown)]
        titles = ["recorded", "ours"]
        for coder in video_coders.coders(measuring.config["codec_effort"]):
            curve = next((one for one in case["codecs"] if one["title"] == coder.title
                          and not one["group"]), None)
            points = [one for one in curve["points"] if one] if curve else []
            if not points:
                continue
            near = min(points, key=lambda one: abs(math.log(one["bytes"] / ours["bytes"])))
            _, other = video_coders.coded(recorded[:at + 1], coder, near["crf"], 0, RATE_HZ)
            row.append(other[at])
            texts.append(_line(near["bytes"], recorded[at], other[at]))
            titles.append(f"{_short(coder.title)}, crf {near['crf']}"
                          if len(cases) == 1 else _short(coder.title))
        rows.append(row)
        below.append(texts)
        labels.append(f"{case['dataset']}, {case['side']}")
    if not rows or any(len(row) != len(rows[0]) for row in rows):
        return None
    file = charts.image_grid(rows, titles, labels, below, measuring.folder / "storage-samples.png")
    return Figure("The image in the middle of each recording, of each codec the measured point that "
                  "is nearest to our bytes: mean bytes of an image of the whole recording, and PSNR "
                  "of this one.", file, "The same image from each codec",
                  is_recorded=any(case["is_recorded"] for case in cases))


def _line(size: float, recorded: quality.Images, shown: quality.Images) -> str:
    return f"{size:,.0f} B, {quality.psnr_db(recorded, shown):.1f} dB"
