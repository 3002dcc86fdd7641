# SPDX-License-Identifier: Apache-2.0
"""Video encoders through FFmpeg: what they make of a clip, in bytes of the bare stream.

They are judged by PSNR, so they are tuned for it, not for the eye. None of them writes its settings
into the stream: x265 would at every key frame (2,288 bytes), x264 once. They code 10 bits inside,
from the same 8-bit images, which takes fewer bytes for the same PSNR. Colours are 4:4:4 with the
matrix of BT.601 and the full range, named both ways: a matrix that is guessed costs up to 5 dB.
"""

from __future__ import annotations

import functools
import pathlib
import subprocess
import tempfile
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from experiments.paper import quality
from experiments.paper.quality import Images


PIXELS = "yuv444p10le"
PLAIN = ("-f", "rawvideo", "-pix_fmt", "rgb24")


@dataclass(frozen=True)
class Coder:
    """`title` as tables and plots name it; `options` of FFmpeg; `suffix` of a stream without a
    container; `largest_crf`: qualities are given in 0 to 51 and scaled to that; `pixels`: FFmpeg's
    format of what is coded."""

    title: str
    encoder: str
    options: tuple[str, ...]
    suffix: str
    largest_crf: int = 51
    pixels: str = PIXELS


def coders(effort: str) -> list[Coder]:
    """`effort`: "best" as for an archive, "quick" as a robot might have time for, or in a test."""
    is_best = effort == "best"
    x264, x265 = ("placebo", "veryslow") if is_best else ("veryfast", "veryfast")
    return [
        # NAL units of type 6 hold messages. libx264 has no option against that of its settings.
        Coder(f"H.264 (x264 {x264})", "libx264",
              ("-preset", x264, "-tune", "psnr", "-bsf:v", "filter_units=remove_types=6"), "h264"),
        Coder(f"H.265 (x265 {x265})", "libx265",
              ("-preset", x265, "-tune", "psnr", "-x265-params", "log-level=error:info=0"),
              "hevc"),
        _av1(2 if is_best else 8),
    ]


def av1(effort: str) -> Coder:
    """The one with the fewest bytes for a PSNR."""
    return _av1(2 if effort == "best" else 8)


def _av1(speed: int) -> Coder:
    """Tuned for PSNR by itself. Without temporal filters or with equal quantisers
    (`deltaq-mode=0`) it took more bytes."""
    return Coder(f"AV1 (libaom cpu-used {speed})", "libaom-av1",
                 ("-cpu-used", str(speed), "-lag-in-frames", "35", "-b:v", "0"), "obu", 63)


@functools.cache
def available() -> str:
    return subprocess.run(["ffmpeg", "-hide_banner", "-encoders"], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True, check=True).stdout


def is_available(coder: Coder) -> bool:
    return f" {coder.encoder} " in available()


def write_stream(images: Images, coder: Coder, crf: int, group: int, rate_hz: float,
                 stream: pathlib.Path) -> None:
    """`group`: a key frame at least every so many; 0: one."""
    height, width = images.shape[1:3]
    scaled_crf = round(crf * coder.largest_crf / 51)
    _ffmpeg([*PLAIN, "-s", f"{width}x{height}", "-r", f"{rate_hz}", "-i", "-",
             "-vf", "scale=out_color_matrix=bt601:out_range=full:"
                    f"flags=accurate_rnd+full_chroma_int,format={coder.pixels}",
             "-color_range", "pc", "-colorspace", "smpte170m", "-c:v", coder.encoder,
             *coder.options, "-crf", str(scaled_crf), "-g", str(group or len(images)),
             "-threads", "1", str(stream)], images.tobytes())


def coded(images: Images, coder: Coder, crf: int, group: int, rate_hz: float) -> tuple[int, Images]:
    """Bytes of the stream, and its images. `group`: a key frame at least every so many; 0: one."""
    height, width = images.shape[1:3]
    with tempfile.TemporaryDirectory() as folder:
        stream = pathlib.Path(folder) / f"stream.{coder.suffix}"
        write_stream(images, coder, crf, group, rate_hz, stream)
        decoded = _ffmpeg(["-threads", "1", "-i", str(stream), "-vf",
                           "scale=in_color_matrix=bt601:in_range=full:"
                           "flags=accurate_rnd+full_chroma_int,format=rgb24",
                           "-fps_mode", "passthrough", *PLAIN, "-"])
        size = stream.stat().st_size
    shown = np.frombuffer(decoded, np.uint8).reshape(-1, height, width, 3)
    if len(shown) != len(images):
        raise RuntimeError(f"{coder.title}: found {len(shown)} images, needs {len(images)}")
    return size, shown


def point(images: Images, coder: Coder, crf: int, group: int, rate_hz: float) -> dict[str, Any]:
    """Bytes of an image and its quality, as all experiments keep them."""
    began = time.monotonic()
    size, shown = coded(images, coder, crf, group, rate_hz)
    each = [quality.psnr_db(*pair) for pair in zip(images, shown, strict=True)]
    return {"crf": crf, "bytes": size / len(shown), "psnr_db": float(np.mean(each)),
            "minimum_db": min(each), "ssim": quality.mean_ssim(images, shown),
            "seconds": round(time.monotonic() - began, 1)}


def _ffmpeg(arguments: list[str], given: bytes | None = None) -> bytes:
    return subprocess.run(["ffmpeg", "-v", "error", "-y", *arguments], input=given,
                          stdout=subprocess.PIPE, check=True).stdout
