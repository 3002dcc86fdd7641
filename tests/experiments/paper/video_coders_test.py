# SPDX-License-Identifier: Apache-2.0
"""Video encoders give back as many images as they get, worse for fewer bytes, and are the best
rivals that they can be."""

import pathlib
from dataclasses import replace

import numpy as np
import pytest

from experiments.paper import quality, video_coders

CODERS = video_coders.coders("quick")


@pytest.fixture(params=CODERS, ids=lambda coder: coder.encoder)
def coder(request) -> video_coders.Coder:
    if not video_coders.is_available(request.param):
        pytest.skip(f"FFmpeg has no {request.param.encoder}")
    return request.param


def moving(count: int) -> quality.Images:
    """A pattern that moves."""
    y, x = np.mgrid[0:64, 0:64]
    return np.stack([np.stack([(x * 3 + 5 * t) % 256, y * 3, x + y], -1)
                     for t in range(count)]).astype(np.uint8)


def textured(count: int) -> quality.Images:
    """A soft texture that moves, with noise: what tuning for the eye and for PSNR differ in."""
    random = np.random.default_rng(1)
    ground = random.normal(size=(64, 64 + 2 * count, 3)).cumsum(0).cumsum(1)
    ground = 255 * (ground - ground.min()) / (ground.max() - ground.min())
    return np.stack([np.clip(ground[:, 2 * t:64 + 2 * t] + random.normal(0, 4, (64, 64, 3)), 0, 255)
                     for t in range(count)]).astype(np.uint8)


def test_worse_images_take_fewer_bytes(coder):
    images = moving(6)
    fine, coarse = (video_coders.coded(images, coder, crf, 0, 5) for crf in (10, 45))
    assert fine[1].shape == coarse[1].shape == images.shape
    assert coarse[0] < fine[0]
    assert quality.mean_psnr_db(images, coarse[1]) < quality.mean_psnr_db(images, fine[1])
    assert quality.mean_psnr_db(images, fine[1]) > 35


def test_no_stream_holds_the_settings_of_its_encoder(coder, tmp_path: pathlib.Path):
    stream = tmp_path / f"stream.{coder.suffix}"
    video_coders.write_stream(moving(4), coder, 45, 1, 5, stream)
    assert b"crf" not in stream.read_bytes()
    assert stream.stat().st_size < 4 * 1500


@pytest.mark.parametrize("name", ["libx264", "libx265"])
def test_tuning_for_psnr_pays_by_psnr(name):
    tuned = next(one for one in CODERS if one.encoder == name)
    if not video_coders.is_available(tuned):
        pytest.skip(f"FFmpeg has no {name}")
    at = tuned.options.index("-tune")
    plain = replace(tuned, options=tuned.options[:at] + tuned.options[at + 2:])
    curves = [[(one["bytes"], one["psnr_db"]) for one in (
        video_coders.point(textured(8), coder, crf, 0, 5) for crf in (20, 34))]
        for coder in (plain, tuned)]
    assert quality.bd_rate(*curves) < 0


def test_a_point_is_the_mean_and_the_minimum_of_its_images():
    coder = video_coders.av1("quick")
    if not video_coders.is_available(coder):
        pytest.skip(f"FFmpeg has no {coder.encoder}")
    images = moving(5)
    size, shown = video_coders.coded(images, coder, 40, 0, 5)
    point = video_coders.point(images, coder, 40, 0, 5)
    assert point["bytes"] == size / 5
    assert point["psnr_db"] == pytest.approx(quality.mean_psnr_db(images, shown))
    assert point["minimum_db"] == min(map(quality.psnr_db, images, shown))
