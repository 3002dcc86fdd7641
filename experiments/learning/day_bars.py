#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How a night consolidates a robot's whole day.

A day of several cameras is made from the videos below RECORDINGS, one after the other, as often as
the day has room for them: each time with other light and colours, shifted, every other time
mirrored, and always with noise of its own. Then one run of the program consolidates it, and
moments drawn at random are decoded and compared with what was recorded. Without an end a night
takes what it needs; --budget tells how a shorter one ends. A store that was made stays in --work.
"""
import argparse
import datetime
import functools
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve()
sys.path.insert(0, str(HERE.parents[2]))
sys.path.insert(0, str(HERE.parent))
import night_bars  # noqa: E402
import numpy as np  # noqa: E402
from experiments.paper import quality  # noqa: E402

HZ = 5
BEGIN = datetime.datetime(2022, 2, 18, 8)
CAMERAS = "Vision/RGB/head/cam{}"
PIECE = 20 * 60 * HZ  # Images of a recording: 20 minutes.
NOISE = 0.5  # Standard deviation, grey levels.
NOISES = 64  # Patterns of noise, drawn from for each image: drawing each anew would take longest.
MAX_SHIFT = 3  # Pixels.
MAX_MEGABYTES = 1500

EXAMPLES = """Examples:
  day_bars.py build/release/bin/engram ../shared/data --work build/day
  day_bars.py build/release/bin/engram ../shared/data --work build/day --budget 1h
  day_bars.py build/release/bin/engram ../shared/data --hours 0.1 --cameras 1
"""


def frames_of(videos, width, height):
    """All images of videos, in a row. Shape: uint8 [n, height, width, 3]."""
    all_frames = []
    for video in videos:
        out = run_bytes(["ffmpeg", "-v", "error", "-i", video, "-vf",
                         f"fps={HZ},scale={width}:{height}:flags=area", "-f", "rawvideo",
                         "-pix_fmt", "rgb24", "-"])
        all_frames.append(np.frombuffer(out, np.uint8).reshape(-1, height, width, 3))
    return np.concatenate(all_frames)


def run_bytes(words):
    done = subprocess.run([str(word) for word in words], capture_output=True)
    if done.returncode != 0:
        raise night_bars.Failed(f"{words[0]}: {done.stderr.decode(errors='replace')[-300:]}")
    return done.stdout


class Day:
    """The images of a camera, by number. The same seed gives the same day."""

    def __init__(self, frames, camera, seed):
        self.frames, self.seed = frames, seed + 1000 * camera
        random = np.random.default_rng(self.seed)
        self.noise = np.round(random.normal(0, NOISE, (NOISES, *frames.shape[1:]))).astype(np.int16)
        self.order = random.permutation(NOISES)
        self.view = functools.lru_cache(maxsize=2)(self.view)

    def view(self, turn):
        """How everything looks in one turn through the recordings."""
        random = np.random.default_rng((self.seed, turn))
        gains = random.uniform(0.85, 1.15) * random.uniform(0.97, 1.03, 3)
        tables = [np.clip(np.round(np.arange(256) * gain), 0, 255).astype(np.uint8)
                  for gain in gains]
        shift = random.integers(-MAX_SHIFT, MAX_SHIFT + 1, 2)
        return tables, shift, turn % 2 == 1

    def images(self, first, count):
        """Consecutive images. Shape: uint8 [count, height, width, 3]."""
        shown = np.empty((count, *self.frames.shape[1:]), np.uint8)
        for number in range(first, first + count):
            turn, at = divmod(number, len(self.frames))
            tables, (down, right), is_mirrored = self.view(turn)
            image = self.frames[at]
            if is_mirrored:
                image = image[:, ::-1]
            padded = np.pad(image, ((MAX_SHIFT,) * 2, (MAX_SHIFT,) * 2, (0, 0)), "edge")
            top, left = MAX_SHIFT + down, MAX_SHIFT + right
            moved = padded[top: top + image.shape[0], left: left + image.shape[1]]
            lit = np.stack([tables[i][moved[..., i]] for i in range(3)], axis=-1)
            noise = self.noise[self.order[number % NOISES]]
            shown[number - first] = np.clip(lit + np.roll(noise, number // NOISES, 0), 0, 255)
        return shown


def record(options, day, camera, store, work):
    """Adds all images of a camera, piece by piece."""
    height, width = day.frames.shape[1:3]
    entity = CAMERAS.format(camera)
    for first in range(0, options.images, PIECE):
        count = min(PIECE, options.images - first)
        piece = work / "piece.mkv"
        writer = subprocess.Popen(
            ["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s",
             f"{width}x{height}", "-r", str(HZ), "-i", "-", "-c:v", "ffv1", "-pix_fmt", "bgr0",
             str(piece)], stdin=subprocess.PIPE)
        for part in range(first, first + count, 256):
            writer.stdin.write(day.images(part, min(256, first + count - part)).tobytes())
        writer.stdin.close()
        if writer.wait() != 0:
            raise night_bars.Failed("ffmpeg could not write a piece of the day")
        begin = BEGIN + datetime.timedelta(seconds=first / HZ)
        night_bars.run([options.engram, "import", "--video", piece, "--entity", entity, "--all",
                        "--start", f"{begin:%Y-%m-%dT%H:%M:%SZ}", store])
        night_bars.tell(f"{entity}: {first + count} of {options.images} images recorded")


def made_day(options, days, work):
    """The recorded day. One that was half made is made anew."""
    store = work / f"day-{options.cameras}x{options.images}-{options.size}-{options.seed}.engram"
    if store.exists():
        night_bars.tell(f"the day is that in {store}")
        return store
    part = store.with_suffix(".part")
    shutil.rmtree(part, ignore_errors=True)
    for camera, day in enumerate(days):
        record(options, day, camera, part, work)
    part.rename(store)
    return store


def consolidate(options, store):
    words = [options.engram, "consolidate", store, "--psnr", options.psnr, "--representation",
             options.representation, "--json"]
    if options.budget:
        words += ["--budget", options.budget]
    more = {"stderr": None} if sys.stderr.isatty() else {}
    out, processor, megabytes = night_bars.run(words, **more)
    return json.loads(out), processor, megabytes


def lowest_psnr(options, days, store):
    """The number of images that latents give back of those asked for, and the lowest PSNR, dB."""
    sys.path.insert(0, str(options.engram.resolve().parents[1] / "python"))
    import engram as package

    random = np.random.default_rng(options.seed)
    found, lowest = 0, math.inf
    with package.open(str(store), prefer="latent") as memory:
        for camera, day in enumerate(days):
            entity = memory[CAMERAS.format(camera)]
            for number in random.integers(0, options.images, options.looks // len(days)):
                when = BEGIN.replace(tzinfo=datetime.timezone.utc)
                when += datetime.timedelta(seconds=int(number) / HZ)
                one = entity.at(when)
                if one.source != "reconstructed":
                    continue
                found += 1
                recorded = day.images(int(number), 1)[0]
                lowest = min(lowest, quality.psnr_db(recorded, one.image))
    return found, lowest


def measure(options, work):
    videos = sorted(pathlib.Path(options.recordings).rglob("*.mp4"))
    if not videos:
        raise night_bars.Failed(f"no *.mp4 below '{options.recordings}'")
    width, height = (int(side) for side in options.size.split("x"))
    days = [Day(frames_of(videos[camera::options.cameras] or videos, width, height), camera,
                options.seed) for camera in range(options.cameras)]
    recorded = made_day(options, days, work)
    store = work / "night.engram"
    shutil.rmtree(store, ignore_errors=True)
    shutil.copytree(recorded, store)
    start = time.monotonic()
    report, processor, megabytes = consolidate(options, store)
    seconds = time.monotonic() - start
    found, lowest = lowest_psnr(options, days, store)
    entities = [{"entity": one["entity"], "encoded": one["encodes"]["images"],
                 "bytes_an_image": one["images"]["kept_bytes"] / max(one["images"]["rows"], 1),
                 "video": one["encodes"]["video"], "notes": one["notes"]}
                if "skipped" not in one else {"entity": one["entity"], "skipped": one["skipped"]}
                for one in report["entities"]]
    return {"images": options.cameras * options.images, "size": options.size,
            "psnr_db": options.psnr, "budget": options.budget, "seconds": seconds,
            "processor_seconds": processor, "megabytes": megabytes, "entities": entities,
            "looks": options.looks, "found": found, "lowest_psnr_db": lowest}


def show(result):
    """Whether the night kept what it promises."""
    encoded = sum(one.get("encoded", 0) for one in result["entities"])
    hours = result["images"] / HZ / 3600
    print(f"a day of {result['images']:,} images of {result['size']} ({hours:.1f} h of one camera)"
          f"\nthe night took {result['seconds']:,.0f} s"
          f"{' of ' + result['budget'] if result['budget'] else ''}, "
          f"{result['processor_seconds']:,.0f} s of processor time, "
          f"{1000 * result['processor_seconds'] / max(encoded, 1):.1f} ms for each of the "
          f"{encoded:,} images that were encoded, {result['megabytes']:.0f} MB")
    for one in result["entities"]:
        if "skipped" in one:
            print(f"  {one['entity']}: skipped: {one['skipped']}")
            continue
        print(f"  {one['entity']}: {one['encoded']:,} images, {one['bytes_an_image']:.0f} bytes an "
              f"image, {one['video']}")
        for note in one["notes"]:
            print(f"    {note}")
    print(f"{result['found']} of {result['looks']} moments drawn at random are latents, the lowest "
          f"has {result['lowest_psnr_db']:.2f} dB (needs {result['psnr_db']:g})")
    keeps_bound = result["found"] > 0 and result["lowest_psnr_db"] >= result["psnr_db"]
    return keeps_bound and encoded > 0 and result["megabytes"] <= MAX_MEGABYTES


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", type=pathlib.Path, help="the program, with its package beside it")
    parser.add_argument("recordings", help="folder with videos (*.mp4), anywhere below")
    parser.add_argument("--hours", type=float, default=8, help="length of the day (8)")
    parser.add_argument("--cameras", type=int, default=2, help="cameras (2)")
    parser.add_argument("--size", type=night_bars.size_text, default="128x128",
                        metavar="WIDTHxHEIGHT", help="size of images (128x128)")
    parser.add_argument("--psnr", type=float, default=35, help="least PSNR of each image, dB (35)")
    parser.add_argument("--representation", choices=["auto", "video"], default="video",
                        help="form of images (video)")
    parser.add_argument("--budget", help="time for the night, such as 1h; else what it needs")
    parser.add_argument("--looks", type=int, default=400, help="moments that are compared (400)")
    parser.add_argument("--seed", type=int, default=1, help="same seed, same day (1)")
    parser.add_argument("--work", type=pathlib.Path, help="folder that keeps the recorded day")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    options = parser.parse_args()
    options.images = int(options.hours * 3600 * HZ)
    if options.images < 16 or options.cameras < 1:
        parser.error(f"found {options.images} images of {options.cameras} cameras, needs 16 and 1")
    if not options.engram.exists():
        parser.error(f"{options.engram}: no such program")
    return options


def main():
    options = arguments_of()
    try:
        with tempfile.TemporaryDirectory(prefix="day_bars-") as folder:
            work = options.work or pathlib.Path(folder)
            work.mkdir(parents=True, exist_ok=True)
            result = measure(options, work)
    except night_bars.Failed as failed:
        sys.exit(f"day_bars: {failed}")
    except KeyboardInterrupt:
        sys.exit(130)
    if options.json:
        options.json.write_text(json.dumps(result, indent=1))
    return 0 if show(result) else 1


if __name__ == "__main__":
    sys.exit(main())
