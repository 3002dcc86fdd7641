# SPDX-License-Identifier: Apache-2.0
"""PSNR and SSIM by scikit-image, and Bjontegaard's rate. Independent of what Engram computes."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PchipInterpolator
from skimage.metrics import structural_similarity

Images = npt.NDArray[np.uint8]
LARGEST_DB = 60.0


def psnr_db(recorded: Images, other: Images) -> float:
    """Of one 8-bit image, at most 60 dB as Engram counts it."""
    from skimage.metrics import mean_squared_error, peak_signal_noise_ratio

    if mean_squared_error(recorded, other) == 0:
        return LARGEST_DB
    return min(LARGEST_DB, float(peak_signal_noise_ratio(recorded, other, data_range=255)))


def ssim(recorded: Images, other: Images) -> float:
    """Of one image [H, W, 3]: Gaussian window of 11 x 11, sigma 1.5, as Wang et al. have it."""
    return float(structural_similarity(
        recorded, other, channel_axis=2, data_range=255, gaussian_weights=True, sigma=1.5,
        use_sample_covariance=False))


def mean_psnr_db(recorded: Images, other: Images) -> float:
    """Mean over images [N, H, W, 3]."""
    return float(np.mean([psnr_db(a, b) for a, b in zip(recorded, other, strict=True)]))


def mean_ssim(recorded: Images, other: Images) -> float:
    return float(np.mean([ssim(a, b) for a, b in zip(recorded, other, strict=True)]))


def _fewest_bytes(points: Sequence[tuple[float, float]]) -> dict[float, float]:
    """By quality, of points (bytes, dB)."""
    return {db: size for size, db in sorted(points, reverse=True)}


def bytes_at(points: Sequence[tuple[float, float]], db: float) -> float | None:
    """The bytes of a curve at that quality, between its points (bytes, dB): logarithms of bytes by
    monotone piecewise cubics. Below its worst point they are those of that point, which is better
    and takes no more. None: above its best point, or without points."""
    best = _fewest_bytes(points)
    if not best or db > max(best):
        return None
    if db <= min(best):
        return best[min(best)]
    qualities = sorted(best)
    logs = [math.log(best[one]) for one in qualities]
    return math.exp(float(PchipInterpolator(qualities, logs)(db)))


def bd_rate(reference: Sequence[tuple[float, float]],
            curve: Sequence[tuple[float, float]]) -> float | None:
    """How many more bytes `curve` needs than `reference` at equal quality, -0.2 a fifth fewer.

    Points are (bytes, dB). Logarithms of bytes over quality are interpolated by monotone piecewise
    cubics and averaged where both were measured. None: they share no range of quality, or one has
    less than two qualities.
    """
    interpolations = []
    for points in (reference, curve):
        best = _fewest_bytes(points)
        if len(best) < 2:
            return None
        qualities = sorted(best)
        interpolations.append((qualities, [math.log(best[db]) for db in qualities]))
    low = max(qualities[0] for qualities, _ in interpolations)
    high = min(qualities[-1] for qualities, _ in interpolations)
    if high <= low:
        return None
    means = [float(PchipInterpolator(*one).integrate(low, high)) / (high - low)
             for one in interpolations]
    return math.exp(means[1] - means[0]) - 1
