# SPDX-License-Identifier: Apache-2.0
"""Tables say what rivals take for what ours give back, and what of ours is no network."""

import pytest

from experiments.loocv import show as loocv
from experiments.storage import show as storage

CURVE = [{"bytes": 90.0, "psnr_db": 31.0}, {"bytes": 50.0, "psnr_db": 28.0}, None]


def case(db: float) -> dict:
    given = {"left_out": {"mean_psnr_db": db}, "left_out_bytes": 311.4, "model_bytes": 1_000_000}
    fold = {"variants": {"rate": given}}
    rival = {"title": "AV1 (libaom cpu-used 2)", "curves": {"16": CURVE, "0": CURVE[:1]}}
    return {"title": "g1", "snapshots": [30, 10], "images": [fold, fold],
            "rivals": [rival, rival]}


def test_a_rival_is_told_at_the_quality_that_ours_reach():
    assert loocv.rival_bytes(case(0)["rivals"][0], 16, 31.0) == (pytest.approx(90), False)
    size, is_upper_bound = loocv.rival_bytes(case(0)["rivals"][0], 16, 29.5)
    assert (50 < size < 90) and not is_upper_bound
    assert loocv.rival_bytes(case(0)["rivals"][0], 16, 32.0) is None
    assert loocv.rival_bytes({"curves": {}}, 16, 30.0) is None


def test_a_rival_that_is_better_at_its_cheapest_takes_no_more_than_that():
    table = loocv._rival_table(case(27.0), ["rate"])
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["bytes of an image"] == ["311", "311", "311"]
    assert rows["AV1, a key frame every 16"] == ["≤ 50", "≤ 50", "≤ 50"]
    assert rows["AV1, one key frame"] == ["≤ 90", "≤ 90", "≤ 90"]
    assert "libaom cpu-used 2" in table.caption


def test_what_is_video_alone_is_said_to_have_no_network():
    rows = {"rows": 304, "latent_rows": 0, "refined_rows": 0, "residual_rows": 0,
            "video_rows": 304, "lossless_rows": 0}
    found = {"images": rows, "has_networks": False}
    assert storage.forms_of(found) == "304 of 304 images as AV1, no network"
    assert storage._without_network(found) == " (no network)"
    found = {"images": {**rows, "video_rows": 4, "latent_rows": 300}, "has_networks": True}
    assert storage.forms_of(found) == "300 of 304 images as latents, 4 of 304 images as AV1"
    assert storage._without_network(found) == storage._without_network(None) == ""
