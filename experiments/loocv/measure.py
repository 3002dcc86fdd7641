# SPDX-License-Identifier: Apache-2.0
"""Leaves each recording out of training and measures it, and checks how that is measured."""

from __future__ import annotations

import functools
import pathlib
import shutil
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from experiments.loocv import agreement
from experiments.paper import quality, video_coders
from experiments.paper.measuring import Measuring
from experiments.paper.recordings import (CAMERA, RATE_HZ, Dataset, datasets, entity_bytes,
                                          make_store, recordings_of)

# Key frames of rivals: as many as our chains have, which gives the same random access, and one.
GROUPS = (16, 0)
UNITS = {"arms": "rad", "joints": "rad", "heading": "rad", "hands": "of 0 to 1", "position": "m",
         "thing_position": "m"}


def measure(measuring: Measuring) -> list[dict[str, Any]]:
    """A result for each dataset; what was not measured is None."""
    return [_Case(measuring, dataset).measure() for dataset in datasets(measuring)]


class _Case:
    """One dataset."""

    def __init__(self, measuring: Measuring, dataset: Dataset) -> None:
        self.measuring, self.dataset, self.config = measuring, dataset, measuring.config
        self.store, key = make_store(measuring, dataset, self.config["side"])
        self.common = {"store": key, "program": measuring.version(), "ahead": self.config["ahead"]}

    def measure(self) -> dict[str, Any]:
        folds = recordings_of(self.store, CAMERA)
        rivals = [self._rivals(number, times) for number, times in enumerate(folds, start=1)]
        earlier = self.measuring.earlier({"dataset": self.dataset.name})
        if earlier is not None:
            return {**earlier, "rivals": rivals}
        images = [self._crossval(f"images, recording {number}", CAMERA, "image_budget", number)
                  for number in range(1, len(folds) + 1)]
        names = [name for name in entity_bytes(self.measuring, self.store) if name != CAMERA]
        checked = self.measuring.measured(
            f"{self.dataset.name} by scikit-image", self.common,
            lambda: agreement.measured(self.store))
        return {
            "dataset": self.dataset.name, "title": self.dataset.title,
            "is_recorded": self.dataset.is_recorded,
            "snapshots": [len(fold) for fold in folds], "images": images,
            "numbers": {name: self._crossval(name.split("/")[-1], name, "number_budget")
                        for name in names},
            "agreement": checked, "rivals": rivals, "sample": self._sample(folds[-1])}

    def _rivals(self, number: int, times: npt.NDArray[np.int64]) -> dict[str, Any]:
        """What AV1 makes of the recording, by the distance of key frames: points, None where they
        were not measured. It learns nothing, so that no recording is left out."""
        coder = video_coders.av1(self.config["codec_effort"])
        images: list[quality.Images] = []

        def code(crf: int, group: int) -> dict[str, Any]:
            if not images:
                images.append(images_of(self.store, times))
            return video_coders.point(images[0], coder, crf, group, RATE_HZ)

        curves: dict[str, list[Any]] = {}
        for group in GROUPS if video_coders.is_available(coder) else ():
            for crf in self.dataset.options.get("rival_crfs", self.config["rival_crfs"]):
                inputs = {"store": self.common["store"], "fold": number, "coder": coder.title,
                          "options": list(coder.options), "pixels": video_coders.PIXELS,
                          "crf": crf, "group": group}
                curves.setdefault(str(group), []).append(self.measuring.measured(
                    f"{self.dataset.name} {coder.title}, recording {number} crf {crf} "
                    f"group {group}", inputs, functools.partial(code, crf, group)))
        return {"title": coder.title, "curves": curves}

    def _crossval(self, what: str, entity: str, budget: str, fold: int | None = None) -> Any:
        inputs = self.common | {
            "entity": entity, "fold": fold, "variants": self.config["variants"],
            "budget": self.config[budget], "width": self.config["width"],
            "psnr": self.config["psnr"]}
        words = ["crossval", self.store, "--entity", entity, "--variants",
                 ",".join(self.config["variants"]), "--max-horizon", self.config["ahead"],
                 "--training", self.config[budget], "--psnr", self.config["psnr"], "--threads", 1]
        if fold is not None:
            words += ["--fold", fold, "--width", self.config["width"]]
        return self.measuring.measured(f"{self.dataset.name} {what}", inputs,
                                       lambda: self.measuring.report(*words)["all"])

    def _sample(self, last: npt.NDArray[np.int64]) -> dict[str, Any] | None:
        """What a model of all recordings but the last predicts of that one: a strip of images."""
        side = self.config["side"]
        seeds = self.dataset.options.get("seeds", "").split(",")
        others = replace(self.dataset, name=f"{self.dataset.name}-all-but-last", options={
            **self.dataset.options, "episodes": self._recordings() - 1,
            "seeds": ",".join(seeds[:-1])})
        inputs = self.common | {"budget": self.config["sample_budget"], "side": side,
                                "psnr": self.config["psnr"]}
        folder = self.measuring.folder / "samples" / self.dataset.name

        def predicted() -> dict[str, Any]:
            import engram

            source, _ = make_store(self.measuring, others, side)
            trained = source.with_suffix(".trained")
            shutil.rmtree(trained, ignore_errors=True)
            shutil.copytree(source, trained)
            self.measuring.run("consolidate", trained, "--entity", CAMERA, "--representation",
                               "latents", "--psnr", self.config["psnr"], "--training",
                               self.config["sample_budget"], "--threads", 1, "--width",
                               self.config["width"])
            with engram.open(self.store) as memory, engram.open(trained) as learned:
                start, end = int(last[0]), int(last[-1])
                recorded = [one.value for one in memory[CAMERA].snapshots(start, end)]
                model = learned[CAMERA].model
                at = _liveliest(np.stack([one["image"] for one in recorded]),
                                self.config["ahead"])
                futures = model.predict(recorded[at - 1:at + 1], self.config["ahead"])
                given = model.images(model.encode([recorded[at]]))[0]
            shutil.rmtree(trained)
            folder.mkdir(parents=True, exist_ok=True)
            ahead = recorded[at + 1:at + 1 + self.config["ahead"]]
            np.savez_compressed(
                folder / "strip.npz", last=recorded[at]["image"], given=given,
                recorded=np.stack([one["image"] for one in ahead]),
                predicted=np.stack([one.value["image"] for one in futures]))
            return {"file": str(folder / "strip.npz"), "at": at}

        found: dict[str, Any] | None = self.measuring.measured(
            f"{self.dataset.name} sample", inputs, predicted, lambda value: [value["file"]])
        return found

    def _recordings(self) -> int:
        return len(recordings_of(self.store, CAMERA))


def images_of(store: pathlib.Path, times: npt.NDArray[np.int64]) -> quality.Images:
    """Images of a recording, as they were recorded."""
    import engram

    with engram.open(store) as memory:
        return np.stack([one.image for one in
                         memory[CAMERA].snapshots(int(times[0]), int(times[-1]))])


def _liveliest(images: quality.Images, ahead: int) -> int:
    """The moment after which most changes, of those with a past and a whole future."""
    thumbs = images[:, ::4, ::4].astype(np.int32)
    changes = [float(np.square(thumbs[at + ahead] - thumbs[at]).mean())
               for at in range(1, len(images) - ahead)]
    return 1 + int(np.argmax(changes))


def files(case: dict[str, Any]) -> pathlib.Path:
    return pathlib.Path(case["sample"]["file"])
