#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What stored videos take, beside libaom with each recording as one group.

Videos below a folder are recorded at 5 Hz and consolidated as video, so that every image keeps a
bound of PSNR. Their rival is libaom `cpu-used 2`: one key frame a recording, so no random access,
and the worst crf at which every image of the recording keeps the bound. It is measured with 8 bits,
as the bars are meant, and with 10 bits inside, the best that we can make of it. Recordings:

    all      all videos as episodes of one entity
    NAME     a video alone
    balanced the images of a video that preset `balanced` keeps, the rival from the same images

Bytes of ours are those of images (video, residuals, heads of chains and references), and those of
everything that the segments of latents hold. PSNR is that of an image in 8-bit RGB.
"""
import argparse
import concurrent.futures
import dataclasses
import datetime
import json
import math
import pathlib
import shutil
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[2]))
sys.path.insert(0, str(HERE.parent))
import night_bars  # noqa: E402
import numpy as np  # noqa: E402
from experiments.paper import video_coders  # noqa: E402

ENTITY = "Vision/RGB/head/cam"
HZ = 5
BEGIN = datetime.datetime(2022, 2, 18, 8)
APART = datetime.timedelta(hours=1)
MAX_CRF = 63
DELIMITER_BYTES = 2  # What an OBU stream has before each image, and no container needs.
# Of everything with time to spare, relative to 8 bits. A bound with none here has no bar.
BARS = {"all": {35: 0.95, 38: 1.02}, "alone": {35: 1.05, 38: 1.05},
        "balanced": {35: 1.15, 38: 1.15}}

EXAMPLES = """Examples:
  group_bars.py build/release/bin/engram ../shared/data/g1 --only all
  group_bars.py build/release/bin/engram ../shared/data/clips --only alone balanced --psnr 35
  group_bars.py build/release/bin/engram my_videos --pace calm --rival 8 --json group_bars.json
"""


def psnr(recorded, decoded):
    """Of the worst image, dB."""
    error = (recorded.astype(np.int32) - decoded).astype(np.float64)
    worst = (error * error).reshape(len(recorded), -1).mean(axis=1).max()
    return math.inf if worst == 0 else 10 * math.log10(255 * 255 / worst)


PIXELS = {8: "yuv444p", 10: "yuv444p10le"}


def rival_of(bits):
    """A crf is given as libaom counts it."""
    return dataclasses.replace(video_coders.av1("best"), largest_crf=51, pixels=PIXELS[bits])


def search_rival(images, bound, bits):
    """The fewest bytes of one group in which every image keeps the bound."""
    coder = rival_of(bits)
    tried = {}

    def measure(crf):
        if crf not in tried:
            size, shown = video_coders.coded(images, coder, crf, 0, HZ)
            tried[crf] = (size - DELIMITER_BYTES * len(images), psnr(images, shown))
        return tried[crf]

    good, bad, crf = 0, MAX_CRF + 1, 36
    while bad - good > 1:
        crf = min(max(crf, good + 1), bad - 1)
        _, worst = measure(crf)
        if worst >= bound:
            good = crf
        else:
            bad = crf
        step = min(max((worst - bound) / 0.3, -MAX_CRF), MAX_CRF)  # Some 0.3 dB a step.
        crf = crf + (math.floor(step) if step < 0 else max(math.floor(step), 1))
        if len(tried) > 4:
            crf = (good + bad) // 2
    # Quality does not fall with each step: a worse crf may keep the bound, too.
    for crf in range(good + 2, min(good + 4, MAX_CRF + 1)):
        measure(crf)
    kept = [size for size, worst in tried.values() if worst >= bound]
    if not kept:
        raise night_bars.Failed(f"libaom: no crf keeps {bound} dB")
    return min(kept)


class Recorded:
    """A store of some videos, and its images by recording."""

    def __init__(self, package, options, name, videos, preset, work):
        self.name, self.path = name, work / f"{name}.engram"
        for number, video in enumerate(videos):
            thinned = ["--preset", preset] if preset else ["--rate", str(HZ)]
            cut = ["--crop-square"] if options.crop_square else []
            night_bars.run([options.engram, "import", "--video", video, "--entity", ENTITY, "--size",
                            options.size, "--start", f"{BEGIN + number * APART:%Y-%m-%dT%H:%MZ}",
                            *thinned, *cut, self.path])
        self.groups, last = [], None
        with package.open(str(self.path)) as memory:
            for snapshot in memory[ENTITY].snapshots():
                hour = (snapshot.time - last) / 1e9 > APART.total_seconds() / 2 if last else True
                if hour:
                    self.groups.append([])
                self.groups[-1].append(np.array(snapshot.image))
                last = snapshot.time
        self.groups = [np.stack(group) for group in self.groups]
        self.images = sum(len(group) for group in self.groups)


def consolidated(package, options, recorded, bound, pace, work):
    """Bytes of images, and of everything, after a night."""
    store = work / f"{recorded.name}-{bound}-{pace}.engram"
    shutil.copytree(recorded.path, store)
    limits = ["--budget", "100h"] if pace == "calm" else []
    out, processor, _ = night_bars.run(
        [options.engram, "consolidate", store, "--psnr", bound, "--representation", "video",
         "--json", "--progress", "none", *limits, *options.more])
    report = json.loads(out)["entities"][0]
    night_bars.run([options.engram, "consolidate", store, "--reuse-models", "--drop-raw", "--psnr",
                    bound, "--progress", "none"])
    with package.open(str(store)) as memory:
        everything = memory[ENTITY].summary()["latent_bytes"]
        decoded = memory[ENTITY].snapshots()
        worst = min(psnr(image[np.newaxis], next(decoded).image)
                    for group in recorded.groups for image in group)
    if worst < bound:
        raise night_bars.Failed(f"{recorded.name}: found an image of {worst:.2f} dB, needs {bound}")
    kept = report["images"]["kept_bytes"]
    shutil.rmtree(store)
    return {"image_bytes": kept, "all_bytes": everything, "processor_seconds": processor,
            "worst_db": worst}


def stores_of(package, options, work):
    """One after the other, with the kind of bar that each has."""
    videos = sorted(pathlib.Path(options.recordings).rglob("*.mp4"))[: options.videos]
    if not videos:
        raise night_bars.Failed(f"no *.mp4 below '{options.recordings}'")
    if "all" in options.only:
        yield "all", Recorded(package, options, "all", videos, None, work)
    for kind in ("alone", "balanced"):
        for video in videos if kind in options.only else []:
            preset = "balanced" if kind == "balanced" else None
            yield kind, Recorded(package, options, f"{video.stem[:24]}-{kind}", [video], preset, work)


def measure(options, work, result):
    sys.path.insert(0, str(pathlib.Path(options.engram).resolve().parents[1] / "python"))
    import engram as package

    for kind, recorded in stores_of(package, options, work):
        for bound in options.psnr:
            row = {"name": recorded.name, "kind": kind, "bound_db": bound,
                   "recordings": len(recorded.groups), "images": recorded.images, "rivals": {},
                   "paces": {}}
            for pace in options.pace:
                night_bars.tell(f"{recorded.name}, {recorded.images} images at {bound:g} dB: {pace}")
                row["paces"][pace] = consolidated(package, options, recorded, bound, pace, work)
            for bits in options.rival:
                night_bars.tell(f"{recorded.name} at {bound:g} dB: libaom, {bits} bits")
                began = time.monotonic()
                with concurrent.futures.ThreadPoolExecutor(2) as pool:
                    sizes = list(pool.map(lambda group: search_rival(group, bound, bits),
                                          recorded.groups))
                row["rivals"][str(bits)] = sum(sizes)
                night_bars.tell(f"{sum(sizes) / recorded.images:.0f} bytes an image, "
                                f"{time.monotonic() - began:.0f} s")
            result.append(row)
        shutil.rmtree(recorded.path)


def bar_of(row):
    return BARS[row["kind"]].get(row["bound_db"])


def ratios(row, pace):
    """Of images and of everything, to each rival."""
    ours = row["paces"][pace]
    return {bits: (ours["image_bytes"] / size, ours["all_bytes"] / size)
            for bits, size in row["rivals"].items()}


def show(result):
    """Whether all bars are reached. They hold for the bytes of images of the calmest night."""
    rows = [["images", "", "dB", "night", "bytes an image", "with all", "libaom 8", "10",
             "images/8", "all/8", "images/10", "bar"]]
    is_reached = True
    for row in result:
        bar = bar_of(row)
        for pace, ours in row["paces"].items():
            each = ratios(row, pace)
            counts = bar is not None and "8" in each and pace == list(row["paces"])[-1]
            is_good = not counts or each["8"][0] <= bar
            is_reached &= is_good
            shown = [f"{size / row['images']:.0f}" if (size := row["rivals"].get(bits)) else "-"
                     for bits in ("8", "10")]
            rows.append([str(row["images"]), row["name"], f"{row['bound_db']:g}", pace,
                         f"{ours['image_bytes'] / row['images']:.0f}",
                         f"{ours['all_bytes'] / row['images']:.0f}", *shown,
                         *(f"{each['8'][i]:.3f}" if "8" in each else "-" for i in (0, 1)),
                         f"{each['10'][0]:.3f}" if "10" in each else "-",
                         f"{bar:g} {'reached' if is_good else 'MISSED'}" if counts else "-"])
    print(night_bars.table(rows))
    return is_reached


def arguments_of(words=None):
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", type=pathlib.Path, help="the program")
    parser.add_argument("recordings", help="folder of videos (*.mp4)")
    parser.add_argument("--videos", type=int, default=100, help="max number of videos (%(default)s)")
    parser.add_argument("--only", nargs="+", choices=list(BARS), default=list(BARS),
                        help="which recordings: " + ", ".join(BARS) + " (all three)")
    parser.add_argument("--size", default="128x128", help="size of images (%(default)s)")
    parser.add_argument("--crop-square", action="store_true",
                        help="take the centre square of each image")
    parser.add_argument("--psnr", type=float, nargs="+", default=[35, 38],
                        help="bounds, dB (35 38)")
    parser.add_argument("--pace", nargs="+", choices=["usual", "calm"], default=["usual", "calm"],
                        help="nights without an end, and with time to spare (both)")
    parser.add_argument("--rival", type=int, nargs="+", choices=[8, 10], default=[8, 10],
                        help="bits inside of libaom (8 10)")
    parser.add_argument("--more", nargs=argparse.REMAINDER, default=[],
                        help="further options of engram consolidate; the last option")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    options = parser.parse_args(words)
    if not options.engram.exists():
        parser.error(f"{options.engram}: no such program")
    return options


def main():
    options = arguments_of()
    result = []
    try:
        with tempfile.TemporaryDirectory(prefix="group_bars-") as folder:
            measure(options, pathlib.Path(folder), result)
    except night_bars.Failed as failed:
        sys.exit(f"group_bars: {failed}")
    finally:
        if options.json and result:
            options.json.write_text(json.dumps(result, indent=1))
    return 0 if show(result) else 1


if __name__ == "__main__":
    sys.exit(main())
