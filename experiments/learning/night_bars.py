#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What `engram consolidate` costs an image at several sizes, and what a robot's day would take.

For each size a store gets so many new images before each night, at 5 Hz, from the videos below
RECORDINGS (without any: from a drawn scene). Each night is one run of the program on all cores that
it likes, with the networks on --threads. Processor time and memory are those of its process; the
program itself says which stage took what.
"""
import argparse
import datetime
import json
import math
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile

CAMERA = "Vision/RGB/head/cam"
HZ = 5
CAMERAS = 2
DAY_IMAGES = CAMERAS * HZ * 8 * 3600
DAY_CORE_SECONDS = 2 * 8 * 3600
# Processor seconds an image by size: what must be reached, and what is aimed at.
NEEDED = {"128x128": (0.07, 0.03), "256x256": (0.10, 0.06), "640x480": (0.15, 0.10)}
MAX_LAST_NIGHT = 1.3
MAX_MEGABYTES = 1500
BEGIN = datetime.datetime(2022, 2, 18, 8)
APART = datetime.timedelta(minutes=5)  # From the start of a piece of a recording to the next.

EXAMPLES = """Examples:
  night_bars.py build/release/bin/engram ../shared/data
  night_bars.py build/release/bin/engram ../shared/data --sizes 128x128 --images 512 --nights 1
  night_bars.py build/release/bin/engram ../shared/data --images 128 48 16 --json night_bars.json
  night_bars.py build/release/bin/engram "" --sizes 64x64 --images 16 --nights 2  # without videos

The last night, with as many new images as the first, shows what older data cost: everything was
once new. An hour is a short time for all of it.
"""


class Failed(Exception):
    """A program failed, or there is too little to measure on."""


def tell(text):
    print(text, file=sys.stderr, flush=True)


def run(words, **more):
    """What a program writes, with its processor seconds and most megabytes, children included."""
    words = [str(word) for word in words]
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(words, stdout=subprocess.PIPE,
                                   stderr=more.get("stderr", errors))
        try:
            out = process.stdout.read()
            _, status, usage = os.wait4(process.pid, 0)
        except KeyboardInterrupt:  # The terminal has told the program, too.
            process.send_signal(signal.SIGINT)
            process.wait()
            raise
        process.returncode = os.waitstatus_to_exitcode(status)
        process.stdout.close()
        errors.seek(0)
        if process.returncode != 0:
            last = errors.read().decode(errors="replace")[-500:]
            raise Failed(f"{' '.join(words[:2])} ended with {process.returncode}: {last}")
    return out.decode(), usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1000


def seconds_of(video):
    out, _, _ = run(["ffprobe", "-v", "error", "-show_entries", "format=duration", "-of",
                     "csv=p=0", video])
    return float(out)


class Recordings:
    """Images of several videos in a row, each of them once."""

    def __init__(self, engram, folder, images, work):
        found = sorted(pathlib.Path(folder).rglob("*.mp4")) if folder else []
        cameras = [video for video in found if "cam_high" in str(video.parent)]
        self.videos = cameras + [video for video in found if video not in cameras]
        self.name = "recordings"
        if not self.videos:
            tell("no recordings: a scene is drawn")
            self.name = "a drawn scene"
            self.videos = [work / "scene.mp4"]
            run([engram, "simulate", "scene", "--seconds", images / HZ + 2, "--width", 640,
                 "--height", 480, "--video", self.videos[0], "--table", work / "scene.csv"])
        self.lengths = [int(seconds_of(video) * HZ) - 1 for video in self.videos]
        if sum(self.lengths) < images:
            raise Failed(f"recordings: {sum(self.lengths)} images at {HZ} Hz below '{folder}', "
                         f"needs {images}: fewer --images or --nights")

    def pieces(self, first, count):
        """Video, first image in it and number of images of each part of a run of images."""
        for video, length in zip(self.videos, self.lengths):
            here = min(length - first, count)
            if here > 0:
                yield video, first, here
                count -= here
            first = max(first - length, 0)


class Store:
    """Gets new images night after night."""

    entity = CAMERA

    def __init__(self, engram, recordings, size, work):
        self.engram, self.recordings, self.size = engram, recordings, size
        self.path = work / f"{size}.engram"
        self.piece = work / "piece.mkv"
        self.images = self.pieces = 0
        shutil.rmtree(self.path, ignore_errors=True)

    def add(self, images):
        """Parts of recordings without loss: whole videos would give nights of unequal length."""
        for video, first, count in self.recordings.pieces(self.images, images):
            width, height = self.size.split("x")
            run(["ffmpeg", "-v", "error", "-y", "-i", video, "-vf",
                 f"fps={HZ},trim=start_frame={first}:end_frame={first + count},"
                 f"setpts=PTS-STARTPTS,scale={width}:{height}:flags=area", "-an", "-c:v", "ffv1",
                 "-pix_fmt", "bgr0", self.piece])
            run([self.engram, "import", "--video", self.piece, "--entity", self.entity, "--all",
                 "--start", f"{BEGIN + self.pieces * APART:%Y-%m-%dT%H:%MZ}", self.path])
            self.pieces += 1
        self.images += images

    def consolidate(self, options, images):
        """One night: what it cost, as measured from outside and as told."""
        words = [self.engram, "consolidate", self.path, "--psnr", options.psnr,
                 "--representation", options.representation, "--threads", options.threads,
                 "--training", f"{max(options.training * images, 0.1):.1f}s", "--json"]
        more = {"stderr": None} if sys.stderr.isatty() else {}
        out, processor, megabytes = run(words, **more)
        entity = json.loads(out)["entities"][0]
        if "skipped" in entity:
            raise Failed(f"{self.size}: skipped: {entity['skipped']}")
        stages = {name: time["processor_seconds"] for name, time in entity["stages"].items()}
        stages["start"] = max(processor - sum(stages.values()), 0)
        encodes, kept = entity["encodes"], entity["images"]
        return {"processor_seconds": processor, "megabytes": megabytes, "stages": stages,
                "seconds": entity["seconds"], "encodes": encodes,
                "bytes_an_image": kept["kept_bytes"] / kept["rows"],
                "psnr_minimum_db": entity["psnr_minimum_db"],
                "is_model_new": entity["is_model_new"], "notes": entity["notes"]}


def day_seconds(night, images):
    """Core seconds of a day: what does not grow with the images once a camera, the rest by image."""
    once = night["stages"]["start"] + night["stages"]["samples"]
    return once * CAMERAS + (night["processor_seconds"] - once) * DAY_IMAGES / images


def measure(options, work, result):
    """Adds to `result` after each night."""
    images = dict(zip(options.sizes, options.images))
    recordings = Recordings(options.engram, options.recordings,
                            options.nights * max(images.values()), work)
    result |= {"psnr_db": options.psnr, "representation": options.representation,
               "threads": options.threads, "training_seconds_an_image": options.training,
               "source": recordings.name, "sizes": []}
    for size in options.sizes:
        store = Store(options.engram, recordings, size, work)
        one = {"size": size, "images": images[size], "nights": []}
        for number in range(1, options.nights + 1):
            tell(f"{size}: night {number} of {options.nights}: "
                 f"{images[size]} new images, {number * images[size]} in all")
            store.add(images[size])
            night = store.consolidate(options, images[size])
            one["nights"].append(night)
            if number == 1:
                one["day_core_seconds"] = day_seconds(night, images[size])
                result["sizes"].append(one)
            tell(f"{size}: night {number} took {night['processor_seconds']:.1f} s of processor "
                 "time")
        shutil.rmtree(store.path)


def table(rows):
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(row, widths))
                     for row in rows)


def stage_table(result):
    """Milliseconds of processor time for each new image."""
    names = list(result["sizes"][0]["nights"][0]["stages"])
    rows = [["size", "night", *names, "all"]]
    for one in result["sizes"]:
        for number, night in enumerate(one["nights"], 1):
            spent = [night["stages"][name] for name in names] + [night["processor_seconds"]]
            rows.append([one["size"], str(number),
                         *(f"{1000 * seconds / one['images']:.1f}" for seconds in spent)])
    return table(rows)


def night_table(result):
    rows = [["size", "night", "new", "encoded", "known", "encodes a chain", "median",
             "bytes an image", "of night 1", "memory", "video"]]
    for one in result["sizes"]:
        first = one["nights"][0]["processor_seconds"]
        for number, night in enumerate(one["nights"], 1):
            encodes = night["encodes"]
            mean, median = encodes["mean_per_search"], encodes["median_per_search"]
            rows.append([one["size"], str(number), str(one["images"]), str(encodes["images"]),
                         str(encodes["known_videos"]),
                         "-" if mean is None else f"{mean:.2f}",
                         "-" if median is None else f"{median:g}",
                         f"{night['bytes_an_image']:.0f}",
                         f"{night['processor_seconds'] / first:.2f}",
                         f"{night['megabytes']:.0f} MB", encodes["video"] or "-"])
    return table(rows)


def verdicts(result):
    """What is said of each bar, and whether all that must be reached are."""
    lines, is_reached = [], True

    def judge(name, got, needed, is_good):
        nonlocal is_reached
        is_reached &= is_good
        lines.append(f"{name:<22} {'reached' if is_good else 'MISSED':<8} {got}  (needs {needed})")

    for one in result["sizes"]:
        each = one["day_core_seconds"] / DAY_IMAGES
        must, aim = NEEDED.get(one["size"], (math.inf, math.inf))
        if must < math.inf:
            judge(f"{one['size']}: an image", f"{each:.3f} s of processor time",
                  f"{must:.2f}, aim {aim:.2f}{' reached' if each <= aim else ''}", each <= must)
        day = one["day_core_seconds"]
        judge(f"{one['size']}: a day", f"{day:,.0f} core seconds for {DAY_IMAGES:,} images, "
              f"{day / DAY_CORE_SECONDS:.1f} nights", f"{DAY_CORE_SECONDS:,}: 8 h of 2 cores",
              day <= DAY_CORE_SECONDS)
        nights = one["nights"]
        if len(nights) > 1:
            ratio = nights[-1]["processor_seconds"] / nights[0]["processor_seconds"]
            judge(f"{one['size']}: night {len(nights)}", f"{ratio:.2f} of the first",
                  f"{MAX_LAST_NIGHT}", ratio <= MAX_LAST_NIGHT)
        megabytes = max(night["megabytes"] for night in nights)
        judge(f"{one['size']}: memory", f"{megabytes:.0f} MB", f"{MAX_MEGABYTES}",
              megabytes <= MAX_MEGABYTES)
    return lines, is_reached


def size_text(text):
    sides = text.split("x")
    if len(sides) != 2 or not all(side.isdigit() and int(side) > 0 for side in sides):
        raise argparse.ArgumentTypeError(f"found '{text}', needs WIDTHxHEIGHT")
    return text


def arguments_of(words=None):
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", type=pathlib.Path, help="the program")
    parser.add_argument("recordings", help='folder with videos, anywhere below; "": none')
    parser.add_argument("--sizes", nargs="+", type=size_text, default=list(NEEDED),
                        metavar="WIDTHxHEIGHT", help="default: " + " ".join(NEEDED))
    parser.add_argument("--images", nargs="+", type=int, default=[128], metavar="N",
                        help="new images a night, one number or one a size (128)")
    parser.add_argument("--nights", type=int, default=3, help="nights at each size (3)")
    parser.add_argument("--psnr", type=float, default=35, help="least PSNR of each image, dB (35)")
    parser.add_argument("--representation", choices=["auto", "video", "latents", "corrected"],
                        default="auto", help="the form of images (auto)")
    parser.add_argument("--threads", type=int, default=1, help="threads of the networks (1)")
    parser.add_argument("--training", type=float, default=0.02, metavar="SECONDS",
                        help="time for training, by the clock, for each new image (0.02: of a day "
                        "1.6 h)")
    parser.add_argument("--work", type=pathlib.Path, help="folder for stores; else a temporary one")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    options = parser.parse_args(words)
    if not options.engram.exists():
        parser.error(f"{options.engram}: no such program")
    if min(options.images) < 16:
        parser.error(f"--images: found {min(options.images)}, needs 16: smaller entities are "
                     "skipped")
    if options.nights < 1:
        parser.error(f"--nights: found {options.nights}, needs 1 or more")
    if len(options.images) == 1:
        options.images *= len(options.sizes)
    if len(options.images) != len(options.sizes):
        parser.error(f"--images: found {len(options.images)} numbers, needs 1 or "
                     f"{len(options.sizes)}")
    return options


def show(options, result):
    """Whether all bars are reached."""
    if options.json:
        options.json.write_text(json.dumps(result, indent=1))
    print(f"{options.representation} at {options.psnr:g} dB, networks on {options.threads} "
          f"thread{'s' if options.threads > 1 else ''}, {options.training:g} s of training an "
          f"image; {result['source']}\n\nprocessor time for each new image, ms\n"
          f"{stage_table(result)}\n\n{night_table(result)}\n")
    lines, is_reached = verdicts(result)
    print("\n".join(lines))
    return is_reached


def main():
    options = arguments_of()
    result = {}
    try:
        with tempfile.TemporaryDirectory(prefix="night_bars-", dir=options.work) as folder:
            measure(options, pathlib.Path(folder), result)
    except Failed as failed:
        sys.exit(f"night_bars: {failed}")
    except KeyboardInterrupt:
        if result.get("sizes"):
            show(options, result)
        sys.exit(130)
    return 0 if show(options, result) else 1


if __name__ == "__main__":
    sys.exit(main())
