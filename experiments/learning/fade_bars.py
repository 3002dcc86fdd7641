#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What remains of images that fade, and for how many bytes.

Videos below a folder are recorded and consolidated. Then all images fade, step by step, once from
what was recorded and once from their latents alone. For each step: the bytes of an image, its real
PSNR against what was recorded, what answers promise of it (expected and certain), and how much the
errors of two steps have in common, as a correlation: the real error is
`before + step + 2 * correlation * sqrt(before * step)`. A promise that an image breaks is counted.
"""
import argparse
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

ENTITY = "Vision/RGB/head/cam"
LATER = "2036-01-01T00:00:00Z"

EXAMPLES = """Examples:
  fade_bars.py build/release/bin/engram ../shared/data/g1
  fade_bars.py build/release/bin/engram ../shared/data/clips --psnr 40 --to 36 gist --crop-square
"""


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"'{' '.join(map(str, command))}' failed:\n{done.stderr}")
    return done.stdout


def record(options, store):
    """Records every video as an episode of its own day. Returns the number of videos."""
    videos = sorted(pathlib.Path(options.recordings).rglob("*.mp4"))[: options.videos]
    if not videos:
        sys.exit(f"no *.mp4 below '{options.recordings}'")
    for day, video in enumerate(videos):
        crop = ["--crop-square"] if options.crop_square else []
        run(options.engram, "import", "--video", video, "--entity", ENTITY, "--size", options.size,
            "--start", f"2026-{1 + day // 28:02}-{1 + day % 28:02}T10:00:00Z", *crop, store)
    return len(videos)


def fade(options, store, target, work):
    """Lets everything fade to a PSNR or to a gist."""
    step = "form: gist" if target == "gist" else f"psnr: {target}"
    config = work / "fade.yaml"
    config.write_text("forget:\n  protect: {newest: 0}\n  fade:\n    - {after: 0s, " + step + "}\n")
    done = json.loads(run(options.engram, "forget", store, "--config", config, "--yes", "--json"))
    return done["done"]["faded"][0] if done["done"]["faded"] else {"faded": 0, "kept": 0}


def latent_bytes(engram_package, store):
    """Bytes of the segments of latents, with everything that is in them."""
    with engram_package.open(str(store)) as memory:
        return memory[ENTITY].summary()["latent_bytes"]


def mse(a, b):
    return float(((a.astype("float64") - b) ** 2).mean())


def psnr(error):
    return math.inf if error == 0 else 10 * math.log10(255 * 255 / error)


def compare(engram_package, recorded, faded):
    """Real, expected and certain errors of every image."""
    real, expected, certain = [], [], []
    with engram_package.open(str(recorded)) as before, engram_package.open(str(faded)) as after:
        for was, now in zip(before[ENTITY].snapshots(), after[ENTITY].snapshots()):
            assert was.time == now.time, "snapshots must not go"
            told = now.instances[0]
            real.append(mse(was.image, now.image))
            expected.append(told.error.image_mse)
            certain.append((told.bound or told.error).image_mse)
    return real, expected, certain


def row_of(name, target, images, size, errors):
    real, expected, certain = errors
    shared = [(r - e) / (c - e) for r, e, c in zip(real, expected, certain) if c > e]
    decibels = [psnr(error) for error in real]
    missed = 0 if target == "gist" else sum(each < float(target) for each in decibels)
    return {"from": name, "target": target, "bytes": size / images, "mean_psnr": sum(decibels) / images,
            "min_psnr": min(decibels), "certain_psnr": psnr(max(certain)), "missed": missed,
            "broken": sum(r > c * (1 + 1e-9) for r, c in zip(real, certain)),
            "max_correlation": max(shared) if shared else None,
            "mean_correlation": sum(shared) / len(shared) if shared else None}


def print_row(row):
    correlation = "-"
    if row["max_correlation"] is not None:
        correlation = f"{row['max_correlation']:.2f} (mean {row['mean_correlation']:.2f})"
    print(f"| {row['from']} | {row['target']} | {row['bytes']:.1f} | {row['mean_psnr']:.2f} | "
          f"{row['min_psnr']:.2f} | {row['certain_psnr']:.2f} | {row['missed']} | {row['broken']} | "
          f"{correlation} |", flush=True)


def measure(options, work):
    sys.path.insert(0, str(pathlib.Path(options.engram).resolve().parents[1] / "python"))
    import engram as package

    recorded = work / "recorded.engram"
    count = record(options, recorded)
    run(options.engram, "consolidate", recorded, "--psnr", options.psnr, "--representation",
        options.representation, "--progress", "none")
    latents = work / "latents.engram"
    shutil.copytree(recorded, latents)
    run(options.engram, "consolidate", latents, "--reuse-models", "--drop-raw", "--psnr", options.psnr,
        "--progress", "none")
    with package.open(str(recorded)) as memory:
        images = sum(1 for _ in memory[ENTITY].snapshots())
    print(f"{count} videos, {images} images of {options.size}, consolidated at {options.psnr} dB\n")
    print("| from | to, dB | bytes | mean PSNR | min | certain | missed | broken | correlation |")
    print("|---|---|---|---|---|---|---|---|---|")
    rows = [row_of("not faded", options.psnr, images, latent_bytes(package, latents),
                   compare(package, recorded, latents))]
    print_row(rows[0])
    for target in options.to:
        fresh = work / f"{target}.engram"
        shutil.copytree(recorded, fresh)
        for name, store in (("recorded", fresh), ("latents", latents)):
            fade(options, store, target, work)
            rows.append(row_of(name, target, images, latent_bytes(package, store),
                               compare(package, recorded, store)))
            print_row(rows[-1])
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", help="the program")
    parser.add_argument("recordings", help="folder of videos (*.mp4)")
    parser.add_argument("--videos", type=int, default=5, help="max number of videos (%(default)s)")
    parser.add_argument("--size", default="128x128", help="size of images (%(default)s)")
    parser.add_argument("--crop-square", action="store_true", help="take the centre square of each image")
    parser.add_argument("--psnr", default="36", help="bound of consolidation, dB (%(default)s)")
    parser.add_argument("--representation", default="video", help="form of images (%(default)s)")
    parser.add_argument("--to", nargs="+", default=["32", "28"],
                        help="steps of fading, one after the other: dB, or gist (32 28)")
    parser.add_argument("--json", help="file for the results")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        rows = measure(options, pathlib.Path(work))
    if options.json:
        pathlib.Path(options.json).write_text(json.dumps(rows, indent=1))
    broken = sum(row["broken"] for row in rows)
    print(f"\n{broken} promises broken")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
