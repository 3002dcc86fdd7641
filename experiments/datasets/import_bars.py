#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How fast a video and its table come into a store, beside FFmpeg, which decodes and scales alone.

Both run in turns; the ratio is the median of those of the rounds (1: as fast as FFmpeg). Memory is
that of the process at its largest. The video is made LOOPS times as long by repeating it, its
table has 30 rows a second.
"""
import argparse
import json
import math
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

NEEDED = 0.8


def run(words):
    """Seconds, and megabytes at most."""
    began = time.monotonic()
    process = subprocess.Popen([str(word) for word in words], stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE)
    errors = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(map(str, words))}: {errors.decode(errors='replace')[-500:]}")
    return time.monotonic() - began, usage.ru_maxrss / 1000


def repeated(video, loops, work):
    long = work / "long.mp4"
    subprocess.run(["ffmpeg", "-v", "error", "-y", "-stream_loop", str(loops - 1), "-i", video,
                    "-c", "copy", "-an", long], check=True)
    return long


def seconds_of(video):
    words = ["ffprobe", "-v", "error", "-show_entries", "format=duration", "-of", "csv=p=0", video]
    return float(subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout)


def write_table(path, seconds):
    with open(path, "w", encoding="ascii") as table:
        table.write("timestamp," + ",".join(f"joint_{i}" for i in range(26)) + "\n")
        for row in range(int(30 * seconds)):
            values = (f"{math.sin(row / 50 + i):.6f}" for i in range(26))
            table.write(f"{row / 30:.6f}," + ",".join(values) + "\n")


def measure(engram, video, size, rounds, work):
    length = seconds_of(video)
    table, store = work / "table.csv", work / "robot.engram"
    write_table(table, length)
    side = size.split("x")[0]
    ffmpeg = ["ffmpeg", "-v", "error", "-i", video, "-vf", f"scale={side}:{side}:flags=area",
              "-pix_fmt", "rgb24", "-f", "null", "-"]
    kinds = {"5 Hz": ["--rate", "5"], "all": ["--all"]}
    times = {name: [] for name in ["FFmpeg", *kinds]}
    memory = dict.fromkeys(times, 0)
    for _ in range(rounds):
        for name in times:
            shutil.rmtree(store, ignore_errors=True)
            words = ffmpeg if name == "FFmpeg" else [
                engram, "import", "--video", video, "--table", table, "--entity",
                "Vision/RGB/head/cam", "--state-entity", "RobotState/Proprioception/robot/joints",
                "--size", size, *kinds[name], store]
            seconds, megabytes = run(words)
            times[name].append(seconds)
            memory[name] = max(memory[name], megabytes)
    rows = []
    for name, taken in times.items():
        ratios = [f / t for f, t in zip(times["FFmpeg"], taken)]
        rows.append({"what": name, "seconds": statistics.median(taken),
                     "ratio": statistics.median(ratios), "megabytes": memory[name]})
    return {"video": pathlib.Path(video).name, "length_s": length, "rows": rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram")
    parser.add_argument("video", type=pathlib.Path)
    parser.add_argument("--size", default="128x128")
    parser.add_argument("--loops", type=int, default=10)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        video = repeated(arguments.video, arguments.loops, work)
        result = measure(arguments.engram, video, arguments.size, arguments.rounds, work)
    print(f"{arguments.video.name} x {arguments.loops}: {result['length_s']:.0f} s, to "
          f"{arguments.size}; {arguments.rounds} rounds")
    print(f"{'':8}{'seconds':>9}{'of FFmpeg':>11}{'memory':>9}")
    for row in result["rows"]:
        print(f"{row['what']:8}{row['seconds']:9.2f}{row['ratio']:11.2f}"
              f"{row['megabytes']:6.0f} MB")
    if arguments.json:
        arguments.json.write_text(json.dumps(result, indent=1))
    min_ratio = min(row["ratio"] for row in result["rows"][1:])
    print(f"import: {min_ratio:.2f} of FFmpeg's speed or more "
          f"({'reached' if min_ratio >= NEEDED else 'MISSED'}, needs {NEEDED})")
    return 0 if min_ratio >= NEEDED else 1


if __name__ == "__main__":
    sys.exit(main())
