# SPDX-License-Identifier: Apache-2.0
"""Tables and plots of what `measure` found."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from experiments.loocv.measure import GROUPS, UNITS, files
from experiments.paper import charts, quality
from experiments.paper.measuring import Measuring
from experiments.paper.recordings import RATE_HZ
from experiments.paper.report import Figure, Section, Table, number, significant

# Mean PSNR in dB by the recording that was left out; the recordings are not public.
PAPER = {
    "reconstruction": (46.83, 48.64, 44.22, 52.72, 48.21),
    "next": (33.68, 32.27, 32.06, 35.53, 33.12),
    "over-next": (28.31, 34.61, 30.05, 30.98, 29.00),
}
VARIANTS = {"rate": "rate-aware", "ae": "AE", "vae": "VAE", "wae": "WAE"}
BASELINES = {"copy-last": "copy of the last", "linear": "line per pixel", "flow": "optical flow"}
KEYS = {16: "a key frame every 16", 0: "one key frame"}
COLOURS = {"rate": "ours", "ae": "blue", "vae": "green", "wae": "purple",
           "copy-last": "grey", "linear": "brown", "flow": "orange"}


def show(measuring: Measuring, cases: list[dict[str, Any]]) -> Section:
    section = Section("loocv", "Leave one recording out")
    section.text(
        "For each recording, models are trained on all others and measured on that one, which they "
        "have never seen: as it is given back by its latents (reconstruction), and as it is "
        "predicted from two images of it, one to "
        f"{measuring.config['ahead']} snapshots ahead at {RATE_HZ} Hz. The rate-aware autoencoder "
        "is what Engram uses by itself: it pays for every bit of its latents, which the others "
        "do not.")
    section.text(
        f"Each model was trained for {measuring.config['image_budget']} on one core, from nothing. "
        "The paper's recordings are not public, so that its figures are no contest: what can be "
        "compared is the protocol.")
    for case in cases:
        section.blocks.append(_fold_table(case, measuring.config["variants"]))
        section.blocks.append(_rival_table(case, measuring.config["variants"]))
    section.blocks.append(_ahead_table(cases))
    if any(all(case["images"]) for case in cases):
        section.blocks.append(_curves(measuring, cases))
    for case in cases:
        if case["sample"] and files(case).exists():
            section.blocks.append(_strip(measuring, case))
    section.blocks.append(_number_table(cases))
    section.blocks.append(_agreement_table(cases))
    return section


def _fold_table(case: dict[str, Any], variants: list[str]) -> Table:
    folds = case["images"]
    named = {name: title for name, title in VARIANTS.items() if name in variants}
    titles = [f"{i + 1} left out ({count})" for i, count in enumerate(case["snapshots"])]
    rows: list[list[str]] = []
    for what in ("reconstruction", "next", "over-next"):
        rows.append([what])
        paper = list(PAPER[what])
        if len(folds) == len(paper):
            rows.append(["the paper's AE", *map(number, paper), number(float(np.mean(paper)))])
        for name, title in (named if what == "reconstruction" else named | BASELINES).items():
            values = [_psnr(fold, what, name) for fold in folds]
            rows.append([title, *map(number, values), number(_mean(values, case["snapshots"]))])
    return Table(f"{case['title']}: mean PSNR in dB of the recording that was left out.",
                 ["", *titles, "all"], rows,
                 "In brackets: images of the recording. “all” is the mean over images; of the "
                 "paper's figures the mean of the five.", paper=["the paper's AE"])


def _rival_table(case: dict[str, Any], variants: list[str]) -> Table:
    """Bytes of what was given back, and of AV1 at the same mean PSNR."""
    folds = list(zip(case["images"], case["rivals"], strict=True))
    titles = [f"{i + 1} left out ({count})" for i, count in enumerate(case["snapshots"])]
    rows: list[list[str]] = []
    for name in (one for one in VARIANTS if one in variants):
        given = [fold and fold["variants"].get(name) for fold, _ in folds]
        ours = [one and float(one["left_out_bytes"]) for one in given]
        models = [one["model_bytes"] for one in given if one]
        model = f", model {np.mean(models) / 1e6:.1f} MB" if models else ""
        rows += [[f"{VARIANTS[name]}{model}"],
                 ["bytes of an image", *map(_bytes, ours), _bytes(_mean(ours, case["snapshots"]))]]
        for group in GROUPS:
            found = [None if one is None else rival_bytes(
                rival, group, float(one["left_out"]["mean_psnr_db"]))
                for one, (_, rival) in zip(given, folds, strict=True)]
            cells = [_bytes(one and one[0], one is not None and one[1]) for one in found]
            mean = _mean([one and one[0] for one in found], case["snapshots"])
            is_upper_bound = any(one is not None and one[1] for one in found)
            rows.append([f"AV1, {KEYS[group]}", *cells, _bytes(mean, is_upper_bound)])
    rival = next((one["title"] for one in case["rivals"] if one["curves"]), "AV1")
    return Table(
        f"{case['title']}: bytes of an image given back, and of {rival} at the same mean PSNR.",
        ["", *titles, "all"], rows,
        "Models were not trained on the recording, AV1 learns nothing. The model is not counted. "
        "“≤”: the cheapest point of AV1 that was measured is better than ours. “all” is the mean "
        "over images.")


def rival_bytes(rival: dict[str, Any], group: int, db: float) -> tuple[float, bool] | None:
    """Bytes of an image of AV1 at that mean PSNR, and whether they are the most that it needs: its
    cheapest point is better. None: not measured, or not that good."""
    points = [(one["bytes"], one["psnr_db"]) for one in rival["curves"].get(str(group), []) if one]
    size = quality.bytes_at(points, db)
    return None if size is None else (size, db < min(one for _, one in points))


def _bytes(size: float | None, is_upper_bound: bool = False) -> str:
    return number(None) if size is None else f"{'≤ ' if is_upper_bound else ''}{size:,.0f}"


def _psnr(fold: dict[str, Any] | None, what: str, name: str) -> float | None:
    if fold is None:
        return None
    if what == "reconstruction":
        one = fold["variants"].get(name)
        return None if one is None else float(one["left_out"]["mean_psnr_db"])
    found = _predictions(fold, name)
    return found[{"next": 0, "over-next": 1}[what]]["mean_psnr_db"] if found else None


def _predictions(fold: dict[str, Any], name: str) -> list[dict[str, Any]] | None:
    found: list[dict[str, Any]] | None = (
        fold["baselines"][name] if name in BASELINES
        else fold["variants"].get(name, {}).get("prediction"))
    return found


def _mean(values: list[float | None], weights: list[int]) -> float | None:
    if any(value is None for value in values):
        return None
    return float(np.average(np.array(values, float), weights=weights))


def over_folds(folds: list[dict[str, Any]], name: str, member: str) -> list[float]:
    """Of each snapshot ahead: the mean over all images of all folds."""
    steps = []
    for ahead in zip(*(_predictions(fold, name) or [] for fold in folds)):
        counts = [one["images"] for one in ahead]
        steps.append(float(np.average([one[member] for one in ahead], weights=counts)))
    return steps


def _ahead_table(cases: list[dict[str, Any]]) -> Table:
    ahead = max((len(fold["baselines"]["linear"]) for case in cases for fold in case["images"]
                 if fold), default=0)
    rows: list[list[str]] = []
    for case in cases:
        folds = [fold for fold in case["images"] if fold]
        if not folds:
            continue
        rows.append([case["title"]])
        for name, title in (VARIANTS | BASELINES).items():
            psnr = over_folds(folds, name, "mean_psnr_db")
            ssim = over_folds(folds, name, "mean_ssim")
            if psnr:
                rows.append([title, *[f"{number(db)} / {number(one, 3)}"
                                      for db, one in zip(psnr, ssim, strict=True)]])
    head = ["snapshots ahead", *[f"{step} ({1000 * step / RATE_HZ:.0f} ms)"
                                 for step in range(1, ahead + 1)]]
    return Table("How predictions of left-out recordings get worse: mean PSNR in dB / mean SSIM "
                 "over the images of all folds.", head, rows)


def _curves(measuring: Measuring, cases: list[dict[str, Any]]) -> Figure:
    shown = [case for case in cases if all(case["images"])]
    figure, axes = charts.panels(len(shown), 1, 5.2, 3.9)
    for axis, case in zip(axes[0], shown, strict=True):
        for name, title in (VARIANTS | BASELINES).items():
            values = over_folds(case["images"], name, "mean_psnr_db")
            if not values:
                continue
            seconds = (1 + np.arange(len(values))) / RATE_HZ
            axis.plot(seconds, values, color=charts.COLOURS[COLOURS[name]], label=title,
                      lw=1.9 if name in VARIANTS else 1.3, marker="o" if name in VARIANTS else "",
                      ms=3.5, ls="-" if name in VARIANTS else "--")
        axis.set_title(case["dataset"])
        axis.set_xlabel("seconds ahead")
        axis.set_ylabel("mean PSNR, dB")
    axes[0, 0].legend(ncol=2)
    file = charts.save(figure, measuring.folder / "loocv-ahead.png")
    return Figure("Predictions of recordings that were left out, beside what needs no learning "
                  "(dashed).", file, "Curves of PSNR against seconds ahead")


def _strip(measuring: Measuring, case: dict[str, Any]) -> Figure:
    with np.load(files(case)) as strip:
        recorded, predicted = strip["recorded"], strip["predicted"]
        last, given = strip["last"], strip["given"]
    steps = [i for i in range(len(recorded)) if i in (0, 1, 2, 4, len(recorded) - 1)]
    titles = ["now", *[f"+{1000 * (i + 1) / RATE_HZ:.0f} ms" for i in steps]]
    rows = [[last, *[recorded[i] for i in steps]], [given, *[predicted[i] for i in steps]],
            [None, *[last for _ in steps]]]
    below = [["" for _ in titles],
             [_line(last, given), *[_line(recorded[i], predicted[i]) for i in steps]],
             ["", *[_line(recorded[i], last) for i in steps]]]
    file = charts.image_grid(rows, titles, ["recorded", "model", "copy of the last"], below,
                             measuring.folder / f"loocv-{case['dataset']}.png")
    return Figure(
        f"{case['title']}: where most changes in the recording that was left out. Below “now” is "
        "what its latents give back; to the right of it, predictions from it and the image before.",
        file, "Images of the future as they were recorded, as predicted, and the last one again",
        is_recorded=case["is_recorded"])


def _line(recorded: quality.Images, other: quality.Images) -> str:
    return f"{quality.psnr_db(recorded, other):.1f} dB"


def _number_table(cases: list[dict[str, Any]]) -> Table:
    rows: list[list[str]] = []
    head = ["RMSE", "unit", "given back", "next", "over-next", "last ahead"]
    for case in cases:
        for name, found in case["numbers"].items():
            short = name.split("/")[-1]
            rows.append([f"{case['dataset']}: {short.replace('_', ' ')}"])
            if found is None:
                rows.append(["all", UNITS[short], *[number(None)] * 4])
                continue
            for key, title in (VARIANTS | BASELINES | {"linear": "straight line"}).items():
                ahead = _predictions(found, key)
                if ahead is None or key == "flow":
                    continue
                given = (significant(found["variants"][key]["left_out"]["rmse"])
                         if key in VARIANTS else "–")
                rows.append([title, UNITS[short], given,
                             *[significant(ahead[i]["rmse"]) for i in (0, 1, -1)]])
    return Table(
        "Joints and poses of recordings that were left out: root mean squared error over all "
        "members and snapshots, in their unit.", head, rows,
        "“given back”: from what is stored, which keeps every number within a bound, whatever the "
        "networks make of it. Angles are not wrapped.")


def _agreement_table(cases: list[dict[str, Any]]) -> Table:
    rows: list[list[str]] = []
    for case in cases:
        if not case["agreement"] or not all(case["images"]):
            continue
        for way, other in case["agreement"].items():
            ours = [over_folds(case["images"], way, member)[0]
                    for member in ("mean_psnr_db", "mean_ssim")]
            theirs = [other["psnr_db"], other["ssim"]]
            rows.append([f"{case['dataset']}, {BASELINES[way]}, next", f"{other['images']:,}",
                         number(ours[0], 6), number(theirs[0], 6), number(ours[1], 8),
                         number(theirs[1], 8), f"{math.fabs(ours[0] - theirs[0]):.1e} / "
                         f"{math.fabs(ours[1] - theirs[1]):.1e}"])
    return Table(
        "The same predictions, measured by <code>engram crossval</code> and once more by NumPy and "
        "scikit-image from the stored images.",
        ["", "images", "PSNR dB", "scikit-image", "SSIM", "scikit-image", "differences"], rows,
        "SSIM with a Gaussian window (sigma 1.5, 11 x 11), population covariance, mean of the "
        "channels.")


def worst_disagreement(cases: list[dict[str, Any]]) -> float:
    """The largest difference in dB or SSIM between Engram's figures and scikit-image's; NaN where
    none was compared."""
    worst = math.nan
    for case in cases:
        if not case["agreement"] or not all(case["images"]):
            continue
        for way, other in case["agreement"].items():
            for member, theirs in (("mean_psnr_db", other["psnr_db"]),
                                   ("mean_ssim", other["ssim"])):
                difference = abs(over_folds(case["images"], way, member)[0] - theirs)
                worst = difference if math.isnan(worst) else max(worst, difference)
    return worst

