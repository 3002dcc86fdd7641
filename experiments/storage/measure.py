# SPDX-License-Identifier: Apache-2.0
"""What recordings take in each stage, and images against video codecs."""

from __future__ import annotations

import functools
import pathlib
import shutil
from typing import Any

import numpy as np

from experiments.paper import quality, video_coders
from experiments.paper.measuring import Measuring, fingerprint
from experiments.paper.recordings import (CAMERA, RATE_HZ, Dataset, datasets, entity_bytes,
                                          make_store, recordings_of)


def measure(measuring: Measuring) -> list[dict[str, Any]]:
    """A result for each dataset and size of images; what was not measured is None."""
    return [_Case(measuring, dataset, side).measure()
            for dataset in datasets(measuring) for side in dataset.options["sides"]]


class _Case:
    """One dataset at one size."""

    def __init__(self, measuring: Measuring, dataset: Dataset, side: int) -> None:
        self.measuring, self.dataset, self.side = measuring, dataset, side
        self.config = measuring.config
        self.name = f"{dataset.name}-{side}"
        self.store, self.key = make_store(measuring, dataset, side)
        self.common = {"store": self.key, "program": measuring.version()}
        self._images: quality.Images | None = None

    def measure(self) -> dict[str, Any]:
        codecs = self._codecs()
        earlier = self.measuring.earlier({"dataset": self.dataset.name, "side": self.side})
        if earlier is not None:
            return {**earlier, "codecs": codecs, "frames": str(self.store)}
        stages = self.measuring.measured(f"{self.name} stages", self.common, self._stages)
        latents = self._latents()
        auto = self.dataset.options.get("auto", {}).get(str(self.side))
        found_auto = auto and self.measuring.measured(
            f"{self.name} auto at {auto['psnr']} dB", self._inputs(auto),
            lambda: self._consolidated(auto, self.store, "auto"), _files)
        number_inputs = self.common | {"budget": self.config["number_budget"]}
        return {"dataset": self.dataset.name, "title": self.dataset.title, "side": self.side,
                "is_recorded": self.dataset.is_recorded,
                "stages": stages, "codecs": codecs, "latents": latents,
                "auto": found_auto, "auto_db": auto and auto["psnr"],
                "targets": self._points(), "frames": str(self.store),
                "numbers": self.measuring.measured(f"{self.name} numbers", number_inputs,
                                                   self._numbers)}

    def images(self) -> quality.Images:
        if self._images is None:
            self._images = images_of(self.store, "recorded")
        return self._images

    def _points(self) -> list[dict[str, Any]]:
        points: list[dict[str, Any]] = self.dataset.options["latents"].get(str(self.side), [])
        return points

    def _inputs(self, point: dict[str, Any]) -> dict[str, Any]:
        return self.common | {"point": point, "width": self.config["width"]}

    def _stages(self) -> dict[str, Any]:
        recordings = recordings_of(self.store, CAMERA)
        entities = entity_bytes(self.measuring, self.store)
        return {
            "seconds": sum(int(one[-1] - one[0]) / 1e9 + 1 / RATE_HZ for one in recordings),
            "recordings": len(recordings), "frames": sum(map(len, recordings)),
            "manifest_bytes": (self.store / "MANIFEST.json").stat().st_size,
            "entities": {name: {"offered": one["offered_bytes"], "kept": one["raw_bytes"],
                                "stored": one["stored_bytes"], "codecs": one["media_codecs"]}
                         for name, one in entities.items()}}

    def _codecs(self) -> list[dict[str, Any]]:
        """A curve per encoder and distance of key frames."""
        curves = []
        for coder in video_coders.coders(self.config["codec_effort"]):
            if not video_coders.is_available(coder):
                self.measuring.say(f"FFmpeg has no {coder.encoder}: left out")
                continue
            for group in self.config["groups"][str(self.side)]:
                points = [self._codec_point(coder, crf, group) for crf in self.config["crfs"]]
                curves.append({"title": coder.title, "group": group, "points": points})
        return curves

    def _codec_point(self, coder: video_coders.Coder, crf: int, group: int) -> Any:
        inputs = {"store": self.key, "coder": coder.title, "options": list(coder.options),
                  "pixels": video_coders.PIXELS, "crf": crf, "group": group}
        return self.measuring.measured(
            f"{self.name} {coder.title} crf {crf} group {group}", inputs,
            lambda: video_coders.point(self.images(), coder, crf, group, RATE_HZ))

    def _latents(self) -> list[dict[str, Any] | None]:
        """Each goes on from the model of the one before it."""
        found: list[dict[str, Any] | None] = []
        source = self.store
        before: list[dict[str, Any]] = []
        for point in self._points():
            inputs = self._inputs(point) | {"before": list(before)}
            one = self.measuring.measured(
                f"{self.name} latents at {point['psnr']} dB", inputs,
                functools.partial(self._consolidated, point, source, "latents"),
                _files)
            found.append(one)
            if one is not None:
                source = pathlib.Path(one["store"])
                before.append(point)
        return found

    def _consolidated(self, point: dict[str, Any], source: pathlib.Path, form: str) -> Any:
        target = source.parent / (
            f"{self.name}-{form}-{point['psnr']}-{fingerprint(self._inputs(point))}.engram")
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(source, target)
        report = self.measuring.report("consolidate", target, *choices(self.config, point, form),
                                       "--force")["entities"][0]
        stored = entity_bytes(self.measuring, target)[CAMERA]
        shown = images_of(target, "latent")
        frames, images = len(shown), report["images"]
        has_networks = form == "latents" or images["latent_rows"] + images["residual_rows"] > 0
        model = report["model_bytes"]
        return {
            "store": str(target), "psnr_asked_db": point["psnr"], "budget": point["budget"],
            "bytes": images["kept_bytes"] / frames, "segment_bytes": stored["latent_bytes"],
            "model_bytes": model, "has_networks": has_networks, "images": images,
            "psnr_db": quality.mean_psnr_db(self.images(), shown),
            "ssim": quality.mean_ssim(self.images(), shown),
            "program_psnr_db": report["psnr_mean_over_images_db"],
            "minimum_db": report["psnr_minimum_db"], "seconds": report["seconds"]}

    def _numbers(self) -> dict[str, Any] | None:
        """Bytes of all that is not an image, within the default bound."""
        before = entity_bytes(self.measuring, self.store)
        names = [name for name in before if name != CAMERA]
        if not names:
            return {"entities": {}}
        target = self.store.with_suffix(".numbers")
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(self.store, target)
        choice = [word for name in names for word in ("--entity", name)]
        report = self.measuring.report("consolidate", target, *choice, "--training",
                                       self.config["number_budget"], "--threads", 1)
        after = entity_bytes(self.measuring, target)
        shutil.rmtree(target)
        rmse = {one["entity"]: one["rmse"] for one in report["entities"]}
        return {"entities": {name: {"latent": after[name]["latent_bytes"],
                                    "model": after[name]["model_bytes"], "rmse": rmse.get(name)}
                             for name in names}}


def choices(config: dict[str, Any], point: dict[str, Any], form: str) -> list[Any]:
    """Options of `engram consolidate`."""
    return ["--entity", CAMERA, "--representation", form, "--psnr", point["psnr"], "--training",
            point["budget"], "--threads", 1, "--width", config["width"]]


def images_of(store: pathlib.Path, prefer: str) -> quality.Images:
    """All images of the camera [N, H, W, 3], from either form."""
    import engram

    with engram.open(store, prefer=prefer) as memory:
        return np.stack([one.image for one in memory[CAMERA].snapshots()])


def _files(value: dict[str, Any]) -> list[str]:
    return [value["store"]]
