# SPDX-License-Identifier: Apache-2.0
"""Reads a whole store and compares it with the raw data, as JSON. Usage: STORE RAW SEEN

SEEN is a file that goes from night to night: all moments that the store ever had, and of those
whose recorded form was dropped, what is decoded of them. Video has to decode to the same bits for
ever, so a hash is kept; networks compute in floating point and may differ by one grey level, so
their images are kept.
"""
from __future__ import annotations

import hashlib
import json
import math
import pathlib
import sys
from typing import Any

import numpy as np
import numpy.typing as npt

import engram
from experiments.month import days

EXACT_FORMS = ("video", "lossless")
MAX_GREY_LEVELS = 1


class Seen:
    """What was read of a store until now."""

    def __init__(self, file: pathlib.Path) -> None:
        self.file = file
        self.moments: dict[str, set[int]] = {days.CAMERA: set(), days.JOINTS: set()}
        self.hashes: dict[int, str] = {}
        self.images: dict[int, npt.NDArray[np.uint8]] = {}
        if not file.exists():
            return
        with np.load(file) as kept:
            for name, moments in self.moments.items():
                moments.update(kept[name.replace("/", ".")].tolist())
            self.hashes = dict(zip(kept["hashed"].tolist(), kept["hashes"].tolist()))
            self.images = dict(zip(kept["pictured"].tolist(), kept["pictures"]))

    def save(self) -> None:
        np.savez(self.file, **{name.replace("/", "."): np.array(sorted(moments), np.int64)
                               for name, moments in self.moments.items()},
                 hashed=np.array(list(self.hashes), np.int64),
                 hashes=np.array(list(self.hashes.values()), "U32"),
                 pictured=np.array(list(self.images), np.int64),
                 pictures=np.array(list(self.images.values()), np.uint8))

    def is_changed(self, moment: int, image: npt.NDArray[np.uint8], is_exact: bool) -> bool:
        """Whether a dropped moment decodes to something else than at first, which is kept."""
        if moment in self.images:
            apart = np.abs(self.images[moment].astype(int) - image).max()
            return bool(apart > MAX_GREY_LEVELS)
        if not is_exact and moment not in self.hashes:
            self.images[moment] = image.copy()
            return False
        digest = hashlib.blake2b(image.tobytes(), digest_size=16).hexdigest()
        return self.hashes.setdefault(moment, digest) != digest


class Raw:
    """Raw days, the last one that was asked for in memory."""

    def __init__(self, folder: pathlib.Path) -> None:
        self.folder = folder
        self.day = 0
        self.data: days.RawDay | None = None

    def row(self, moment: int) -> tuple[days.RawDay, int]:
        day = days.day_of(moment)
        if self.data is None or day != self.day:
            self.day, self.data = day, days.RawDay.load(days.file_of(self.folder, day))
        return self.data, self.data.places[moment]


def psnr(real: npt.NDArray[np.uint8], image: npt.NDArray[np.uint8]) -> float:
    error = float(((real.astype(np.float64) - image) ** 2).mean())
    return math.inf if error == 0 else 10 * math.log10(255**2 / error)


class Camera:
    """Counts of all images of a store."""

    def __init__(self, raw: Raw, seen: Seen, forms: dict[int, str]) -> None:
        self.raw, self.seen, self.forms = raw, seen, forms
        self.recorded: list[int] = []  # Moments whose recorded form is there.
        self.dropped = self.changed = self.unlike_raw = self.encoded = 0
        self.min_psnr_db = math.inf
        self.by_form: dict[str, int] = {}

    def take(self, snapshot: Any) -> None:
        """Takes the answer about a moment, in its recorded form where that is there."""
        data, row = self.raw.row(snapshot.time)
        self.seen.moments[days.CAMERA].add(snapshot.time)
        if snapshot.source == "recorded":
            self.recorded.append(snapshot.time)
            self.unlike_raw += not np.array_equal(data.images[row], snapshot.image)
            return
        self.take_encoded(snapshot)
        self.dropped += 1
        is_exact = self.forms.get(snapshot.time, "") in EXACT_FORMS
        self.changed += self.seen.is_changed(snapshot.time, snapshot.image, is_exact)

    def take_encoded(self, snapshot: Any) -> None:
        data, row = self.raw.row(snapshot.time)
        self.encoded += 1
        self.min_psnr_db = min(self.min_psnr_db, psnr(data.images[row], snapshot.image))
        form = self.forms.get(snapshot.time, "unknown")
        self.by_form[form] = self.by_form.get(form, 0) + 1


def read_camera(store: str, raw: Raw, seen: Seen) -> dict[str, Any]:
    before = set(seen.moments[days.CAMERA])
    with engram.open(store) as memory:
        entity = memory[days.CAMERA]
        kept = entity.errors()
        forms = dict(zip(kept["time"].astype(np.int64).tolist(), kept["form"].tolist()))
        camera = Camera(raw, seen, forms)
        found = set()
        for snapshot in entity.snapshots():
            camera.take(snapshot)
            found.add(snapshot.time)
    waiting = 0
    if camera.recorded:
        is_recorded = set(camera.recorded)
        with engram.open(store, prefer="latent") as memory:
            span = memory[days.CAMERA].snapshots(min(is_recorded), max(is_recorded))
            for snapshot in span:
                if snapshot.time not in is_recorded:
                    continue
                if snapshot.source == "recorded":
                    waiting += 1
                else:
                    camera.take_encoded(snapshot)
    return {"images": len(found), "dropped": camera.dropped, "encoded": camera.encoded,
            "waiting": waiting, "changed": camera.changed, "unlike_raw": camera.unlike_raw,
            "missing": len(before - found), "forms": camera.by_form,
            "min_psnr_db": camera.min_psnr_db if camera.encoded else None}


def read_joints(store: str, raw: Raw, seen: Seen) -> dict[str, Any]:
    before, found = set(seen.moments[days.JOINTS]), set()
    max_error = 0.0
    waiting = dropped = 0
    with engram.open(store) as recorded, engram.open(store, prefer="latent") as encoded:
        for one, other in zip(recorded[days.JOINTS].snapshots(),
                              encoded[days.JOINTS].snapshots(), strict=True):
            data, row = raw.row(one.time)
            for snapshot in (one, other):
                apart = np.abs(data.joints[row].astype(np.float64) - snapshot.value["position"])
                max_error = max(max_error, float(apart.max()))
            found.add(one.time)
            waiting += other.source == "recorded"
            dropped += one.source != "recorded"
    seen.moments[days.JOINTS] |= found
    return {"rows": len(found), "dropped": dropped, "waiting": waiting,
            "missing": len(before - found), "max_error": max_error}


def main() -> None:
    store, folder, seen_file = sys.argv[1:]
    raw, seen = Raw(pathlib.Path(folder)), Seen(pathlib.Path(seen_file))
    result = {days.CAMERA: read_camera(store, raw, seen),
              days.JOINTS: read_joints(store, raw, seen)}
    seen.save()
    print(json.dumps(result))


if __name__ == "__main__":
    main()
