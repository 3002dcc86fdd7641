# SPDX-License-Identifier: Apache-2.0
"""The figures of predictions that learn nothing, once more: by NumPy and scikit-image."""

from __future__ import annotations

import pathlib
from typing import Any

import numpy as np

from experiments.paper import quality
from experiments.paper.recordings import CAMERA, recordings_of


def measured(store: pathlib.Path) -> dict[str, Any]:
    """Mean PSNR and SSIM of the next image by a copy of the last and by a straight line per pixel,
    as `engram crossval` defines them: from the third image of each recording on."""
    import engram

    found: dict[str, list[tuple[float, float]]] = {"copy-last": [], "linear": []}
    with engram.open(store) as memory:
        for times in recordings_of(store, CAMERA):
            images = [one.image for one in
                      memory[CAMERA].snapshots(int(times[0]), int(times[-1]))]
            for before, last, following in zip(images, images[1:], images[2:]):
                line = 2 * last.astype(np.int32) - before
                for way, other in (("copy-last", last),
                                   ("linear", np.clip(line, 0, 255).astype(np.uint8))):
                    found[way].append((quality.psnr_db(following, other),
                                       quality.ssim(following, other)))
    return {way: {"images": len(values), "psnr_db": float(np.mean([db for db, _ in values])),
                  "ssim": float(np.mean([ssim for _, ssim in values]))}
            for way, values in found.items()}
