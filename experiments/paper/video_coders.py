# SPDX-License-Identifier: Apache-2.0
"""Video encoders through FFmpeg: what they make of a clip, in bytes of the bare stream.

Colours are 4:4:4 with the matrix of BT.601 and the full range, named both ways: a matrix that is
guessed costs up to 5 dB.
"""

from __future__ import annotations

import functools
import pathlib
import subprocess
import tempfile
from dataclasses import dataclass

import numpy as np

from experiments.paper.quality import Images


@dataclass(frozen=True)
class Coder:
    """`title` as tables and plots name it; `options` of FFmpeg; `suffix` of a stream without a
    container; `largest_crf`: qualities are given in 0 to 51 and scaled to that."""

    title: str
    encoder: str
    options: tuple[str, ...]
    suffix: str
    largest_crf: int = 51


def coders(effort: str) -> list[Coder]:
    """`effort`: "best" as for an archive, "quick" as a robot might have time for, or in a test."""
    is_best = effort == "best"
    preset = "veryslow" if is_best else "veryfast"
    return [
        Coder(f"H.264 (x264 {preset})", "libx264", ("-preset", preset), "h264"),
        Coder(f"H.265 (x265 {preset})", "libx265",
              ("-preset", preset, "-x265-params", "log-level=error"), "hevc"),
        Coder(f"AV1 (libaom cpu-used {2 if is_best else 8})", "libaom-av1",
              ("-cpu-used", "2" if is_best else "8", "-lag-in-frames", "35", "-b:v", "0"), "obu",
              63),
    ]


@functools.cache
def available() -> str:
    return subprocess.run(["ffmpeg", "-hide_banner", "-encoders"], stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, text=True, check=True).stdout


def is_available(coder: Coder) -> bool:
    return f" {coder.encoder} " in available()


def coded(images: Images, coder: Coder, crf: int, group: int, rate_hz: float) -> tuple[int, Images]:
    """Bytes of the stream, and its images. `group`: a key frame at least every so many; 0: one."""
    height, width = images.shape[1:3]
    plain = ["-f", "rawvideo", "-pix_fmt", "rgb24"]
    scaled_crf = round(crf * coder.largest_crf / 51)
    with tempfile.TemporaryDirectory() as folder:
        stream = pathlib.Path(folder) / f"stream.{coder.suffix}"
        _ffmpeg([*plain, "-s", f"{width}x{height}", "-r", f"{rate_hz}", "-i", "-",
                 "-vf", "scale=out_color_matrix=bt601:out_range=full:flags=accurate_rnd+full_chroma_int,"
                        "format=yuv444p",
                 "-color_range", "pc", "-colorspace", "smpte170m", "-c:v", coder.encoder,
                 *coder.options, "-crf", str(scaled_crf), "-g", str(group or len(images)),
                 "-threads", "1", str(stream)], images.tobytes())
        decoded = _ffmpeg(["-threads", "1", "-i", str(stream), "-vf",
                           "scale=in_color_matrix=bt601:in_range=full:"
                           "flags=accurate_rnd+full_chroma_int,format=rgb24",
                           "-fps_mode", "passthrough", *plain, "-"])
        size = stream.stat().st_size
    shown = np.frombuffer(decoded, np.uint8).reshape(-1, height, width, 3)
    if len(shown) != len(images):
        raise RuntimeError(f"{coder.title}: found {len(shown)} images, needs {len(images)}")
    return size, shown


def _ffmpeg(arguments: list[str], given: bytes | None = None) -> bytes:
    return subprocess.run(["ffmpeg", "-v", "error", "-y", *arguments], input=given,
                          stdout=subprocess.PIPE, check=True).stdout
