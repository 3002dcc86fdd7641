# SPDX-License-Identifier: Apache-2.0
"""What must hold of a month, judged from the figures of its nights.

Figures are a list of nights, each {"night", "stores": {"auto" and "video": what nights.pass_night
returns}}. A month that is not over yet is judged as far as it has come.
"""
from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from experiments.month import days
from experiments.month.nights import NUMBER_BOUND, PSNR_DB

MAX_BYTES = 1.02
MAX_COSTS = 1.2
MIN_WITHIN, MAX_WITHIN = 0.87, 0.95
MAX_NIGHTS_TO_CATCH_UP = 3
# Computing the same mean in another order may differ in the last bits.
ROUNDING = 1 + 1e-9

Figures = list[dict[str, Any]]


@dataclass(frozen=True)
class Verdict:
    """What is said of one check. `held`: None where the month is too short for it."""

    number: int
    name: str
    held: bool | None
    found: str
    missed: tuple[str, ...] = ()  #: Where it did not hold, in words.

    @property
    def word(self) -> str:
        return {True: "held", False: "MISSED", None: "-"}[self.held]


def each_store(figures: Figures) -> Iterator[tuple[str, int, str, dict[str, Any]]]:
    """Where, night, name of the store and its figures."""
    for night in figures:
        for name, store in night["stores"].items():
            yield f"night {night['night']}, {name}", night["night"], name, store


def wholeness(plan: days.Plan, figures: Figures) -> Verdict:
    """Nights end as they should, and no store is ever damaged."""
    missed = []
    for where, number, _, store in each_store(figures):
        missed += [f"{where}: {one}" for one in store["damage"]]
        wanted = {plan.killed: "killed", plan.full: "with 1"}.get(number, "well")
        if store["job"]["ended"] != wanted:
            said = "".join(f": {line[-120:]}" for line in store["job"].get("said", []))
            missed.append(f"{where}: was to end {wanted}, ended {store['job']['ended']}{said}")
    return Verdict(0, "stores are whole after every night", not missed,
                   f"{len(figures)} nights", tuple(missed))


def bounds_kept(plan: days.Plan, figures: Figures) -> Verdict:
    """Every moment that was recorded is read again, and as good as promised."""
    missed, worst_db, images = [], math.inf, 0
    recorded: dict[tuple[str, str], int] = {}
    for where, _, name, store in each_store(figures):
        camera, joints = store["read"][days.CAMERA], store["read"][days.JOINTS]
        images += camera["images"]
        if camera["min_psnr_db"] is not None:
            worst_db = min(worst_db, camera["min_psnr_db"])
            if camera["min_psnr_db"] < PSNR_DB:
                missed.append(f"{where}: an image with {camera['min_psnr_db']:.2f} dB")
        if camera["unlike_raw"]:
            missed.append(f"{where}: {camera['unlike_raw']} recorded images differ from what came")
        # Half a millionth: joints are stored with 32 bits.
        if joints["max_error"] > NUMBER_BOUND + 5e-7:
            missed.append(f"{where}: joints are wrong by {joints['max_error']:.6f} rad")
        for entity, kept, found in ((days.CAMERA, "kept", camera["images"]),
                                    (days.JOINTS, "kept_joints", joints["rows"])):
            key = (name, entity)
            recorded[key] = recorded.get(key, 0) + store["recorded"][kept]
            if found != recorded[key] or store["read"][entity]["missing"]:
                missed.append(f"{where}: {found} of {recorded[key]} moments of {entity} are there")
    return Verdict(1, f"every stored image keeps {PSNR_DB:g} dB", not missed,
                   f"min {worst_db:.2f} dB of {images} images that were read", tuple(missed))


def dropped_unchanged(plan: days.Plan, figures: Figures) -> Verdict:
    """What was dropped decodes to the same for ever."""
    missed, dropped = [], 0
    for where, _, _, store in each_store(figures):
        camera = store["read"][days.CAMERA]
        dropped = max(dropped, camera["dropped"])
        if camera["changed"]:
            missed.append(f"{where}: {camera['changed']} of {camera['dropped']} images changed")
    held = not missed if dropped else None
    return Verdict(2, "what was dropped never changes", held,
                   f"{dropped} images of a store were dropped in the end", tuple(missed))


def kept_bytes(store: dict[str, Any]) -> int:
    sizes = store["sizes"]
    total: int = sizes["latent_bytes"] + sizes["model_bytes"] + sizes["manifest_bytes"]
    return total


def bytes_ratio(night: dict[str, Any]) -> float:
    return kept_bytes(night["stores"]["auto"]) / kept_bytes(night["stores"]["video"])


def images_ratio(night: dict[str, Any]) -> float | None:
    """The same of the camera alone, whose latents and models are what the two stores differ in."""
    auto, video = (night["stores"][name]["sizes"]["image_bytes"] for name in ("auto", "video"))
    return auto / video if video else None


def bytes_small(plan: days.Plan, figures: Figures) -> Verdict:
    """Latents, models and manifest beside those of video alone; the camera's by themselves, too,
    so that nothing is hidden behind joints."""
    found, missed = [], []
    late = [night for night in figures if night["night"] >= plan.bytes_from]
    for what, ratio_of in (("everything", bytes_ratio), ("images", images_ratio)):
        ratios = {night["night"]: ratio_of(night) or 1.0 for night in late}
        missed += [f"night {number}: {what} {ratio:.4f}" for number, ratio in ratios.items()
                   if ratio > MAX_BYTES]
        if ratios:
            found.append(f"{what} max {max(ratios.values()):.4f}, last "
                         f"{list(ratios.values())[-1]:.4f}")
    return Verdict(3, f"auto takes at most {MAX_BYTES} of video alone from night {plan.bytes_from}",
                   not missed if late else None, "; ".join(found) or "no such night yet",
                   tuple(missed))


def models_few(plan: days.Plan, figures: Figures) -> Verdict:
    """Models of an entity, beside how often the scene changed."""
    missed, largest = [], 0
    for where, number, _, store in each_store(figures):
        for entity, count in store["sizes"]["models"].items():
            largest = max(largest, count)
            if count > 1 + plan.changes_until(number):
                missed.append(f"{where}: {count} models of {entity} after "
                              f"{plan.changes_until(number)} changes")
    return Verdict(4, "models of an entity: at most 1 + changes of scene", not missed,
                   f"max {largest}", tuple(missed))


def costs_steady(plan: days.Plan, figures: Figures) -> Verdict:
    """Processor time and memory of a late night beside an early one."""
    by_night = {night["night"]: night for night in figures}
    if plan.early not in by_night or plan.late not in by_night:
        return Verdict(5, f"night {plan.late} costs at most {MAX_COSTS} of night {plan.early}",
                       None, "no such night yet")
    found, missed = [], []
    for name in by_night[plan.late]["stores"]:
        early, late = (by_night[number]["stores"][name]["job"]
                       for number in (plan.early, plan.late))
        for key, what in (("processor_seconds", "processor time"), ("megabytes", "memory")):
            ratio = late[key] / early[key]
            found.append(f"{name} {what} {ratio:.2f}")
            if ratio > MAX_COSTS:
                missed.append(f"{name}: {what} {late[key]:.0f} of {early[key]:.0f}")
    return Verdict(5, f"night {plan.late} costs at most {MAX_COSTS} of night {plan.early}",
                   not missed, ", ".join(found), tuple(missed))


def within_share(counts: dict[str, Any]) -> float | None:
    """Share of errors within their bounds; None without any."""
    return counts["within"] / counts["bounds"] if counts["bounds"] else None


def width_ratio(counts: dict[str, Any]) -> float | None:
    """Mean bound of predictions beside that of copying, as roots of mean squares."""
    return counts["width"] / counts["copy_width"] if counts["copy_width"] else None


@dataclass
class Coverage:
    """How often bounds held on all days together, and on how many days as often as they should."""

    days: int = 0
    days_inside: int = 0
    bounds: int = 0
    within: int = 0
    width: float = 0
    copy_width: float = 0

    def add(self, counts: dict[str, Any], is_inside: bool) -> None:
        self.days += 1
        self.days_inside += is_inside
        self.bounds += counts["bounds"]
        self.within += counts["within"]
        self.width += counts["width"]
        self.copy_width += counts["copy_width"]

    def told(self) -> str:
        width = f", {self.width / self.copy_width:.2f} as wide" if self.copy_width else ""
        return (f"{100 * self.within / self.bounds:.1f} % of all days together{width}, "
                f"{self.days_inside} of {self.days} days inside")


def predictions_bounded(plan: days.Plan, figures: Figures) -> Verdict:
    """Bounds of predictions of a day that no model has seen."""
    missed: list[str] = []
    totals: dict[str, Coverage] = {}
    for where, number, name, store in each_store(figures):
        if number == 1:
            continue  # There is no model yet.
        for entity, counts in store["predicted"].items():
            short = "images" if entity == days.CAMERA else "joints"
            share, ratio = within_share(counts), width_ratio(counts)
            if share is None:
                missed.append(f"{where}: no bounds of {short}")
                continue
            is_inside = MIN_WITHIN <= share <= MAX_WITHIN
            totals.setdefault(f"{name} {short}", Coverage()).add(counts, is_inside)
            if not is_inside:
                missed.append(f"{where}: {100 * share:.1f} % of {counts['bounds']} {short} within")
            if ratio is not None and ratio > ROUNDING:
                missed.append(f"{where}: bounds of {short} are {ratio:.3f} as wide as copying's")
    found = "; ".join(f"{name} {total.told()}" for name, total in totals.items())
    return Verdict(6, "bounds hold for 87 to 95 % of the next day, no wider than copying's",
                   not missed if totals or missed else None, found or "no such night yet",
                   tuple(missed))


def caught_up(plan: days.Plan, figures: Figures) -> Verdict:
    """What waits after a night that was cut short is done three nights later."""
    missed, found = [], []
    names = {plan.short: "short", plan.killed: "killed", plan.full: "full disk"}
    by_night = {night["night"]: night["stores"] for night in figures}
    for number, what in sorted(names.items()):
        if number not in by_night:
            continue
        for name in by_night[number]:
            waits = {later: waiting_in(by_night[later][name]) for later in range(
                number, number + MAX_NIGHTS_TO_CATCH_UP + 1) if later in by_night}
            found.append(f"{what} {name} {', '.join(map(str, waits.values()))}")
            if waits[number] == 0:
                missed.append(f"night {number}, {name}: {what}, and yet nothing waits")
            is_over = number + MAX_NIGHTS_TO_CATCH_UP in waits
            if is_over and 0 not in list(waits.values())[1:]:
                missed.append(f"night {number}, {name}: {what}, and {waits} wait")
    return Verdict(7, f"nights cut short are made up for in {MAX_NIGHTS_TO_CATCH_UP}",
                   not missed if found else None,
                   "waiting: " + "; ".join(found) if found else "no such night yet", tuple(missed))


def waiting_in(store: dict[str, Any]) -> int:
    total: int = sum(entity["waiting"] for entity in store["read"].values())
    return total


CHECKS: tuple[Callable[[days.Plan, Figures], Verdict], ...] = (
    wholeness, bounds_kept, dropped_unchanged, bytes_small, models_few, costs_steady,
    predictions_bounded, caught_up)


def judge(plan: days.Plan, figures: Figures) -> list[Verdict]:
    return [check(plan, figures) for check in CHECKS]
