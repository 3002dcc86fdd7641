# SPDX-License-Identifier: Apache-2.0
"""Video encoders give back as many images as they get, worse for fewer bytes."""

import numpy as np
import pytest

from experiments.paper import quality, video_coders


@pytest.mark.parametrize("coder", video_coders.coders("quick"), ids=lambda coder: coder.encoder)
def test_worse_images_take_fewer_bytes(coder):
    if not video_coders.is_available(coder):
        pytest.skip(f"FFmpeg has no {coder.encoder}")
    y, x = np.mgrid[0:64, 0:64]
    images = np.stack([np.stack([(x * 3 + 5 * t) % 256, y * 3, x + y], -1)
                       for t in range(6)]).astype(np.uint8)
    fine, coarse = (video_coders.coded(images, coder, crf, 0, 5) for crf in (10, 45))
    assert fine[1].shape == coarse[1].shape == images.shape
    assert coarse[0] < fine[0]
    assert quality.mean_psnr_db(images, coarse[1]) < quality.mean_psnr_db(images, fine[1])
    assert quality.mean_psnr_db(images, fine[1]) > 35
