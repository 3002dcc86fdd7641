# SPDX-License-Identifier: Apache-2.0
"""Stored videos are measured beside one group a recording, and judged."""

import pathlib
import sys

import numpy as np
import pytest

FOLDER = pathlib.Path(__file__).resolve().parents[3] / "experiments" / "learning"
sys.path.insert(0, str(FOLDER))
import group_bars  # noqa: E402
import night_bars  # noqa: E402


def row(image_bytes, rival, kind="all", bound=35.0):
    ours = {"image_bytes": image_bytes, "all_bytes": image_bytes + 100, "processor_seconds": 1.0,
            "worst_db": bound}
    return {"name": "some", "kind": kind, "bound_db": bound, "recordings": 2, "images": 10,
            "rivals": {"8": rival, "10": rival - 50}, "paces": {"usual": ours, "calm": ours}}


def test_bars_are_judged(capsys):
    assert group_bars.show([row(950, 1000)])
    assert "reached" in capsys.readouterr().out
    assert not group_bars.show([row(951, 1000)])
    assert "MISSED" in capsys.readouterr().out
    assert group_bars.show([row(1150, 1000, kind="balanced")])
    assert not group_bars.show([row(1050, 1000), row(1051, 1000, kind="alone")])
    assert group_bars.show([row(2000, 1000, bound=36.0)]), "no bar at this bound"


def test_the_worst_image_counts():
    images = np.full((2, 4, 4, 3), 100, np.uint8)
    shown = images.copy()
    shown[1] += 5
    assert group_bars.psnr(images, images) == float("inf")
    assert group_bars.psnr(images, shown) == pytest.approx(34.15, abs=0.01)
    assert group_bars.psnr(images, shown) == pytest.approx(group_bars.psnr(shown, images))


def test_a_rival_keeps_the_bound_with_the_fewest_bytes(monkeypatch):
    tried = []

    def coded(images, coder, crf, group, rate_hz):
        tried.append(crf)
        assert group == 0, "one key frame"
        shown = images.copy()
        shown[0] += np.uint8(1 + crf // 10)  # 34.15 dB from crf 40 on.
        return 2000 - 20 * crf, shown

    monkeypatch.setattr(group_bars.video_coders, "coded", coded)
    images = np.full((2, 4, 4, 3), 100, np.uint8)
    assert group_bars.search_rival(images, 35.0, 8) == 2000 - 20 * 39 - 4
    assert max(tried) <= group_bars.MAX_CRF and len(tried) == len(set(tried))
    with pytest.raises(night_bars.Failed):
        group_bars.search_rival(images, 80.0, 8)
