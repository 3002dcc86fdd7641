#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How nights of `engram consolidate --budget` end that are too short for a day, or longer than it.

A store gets a small camera and a large one. One night without an end tells how long everything
takes. Then the same day is consolidated in nights of a share of that time, until nothing waits: what
each took beside its budget, what waits after it, and what the images take in the end, beside the
night without an end. A share above 1 is a night with time to spare.
"""
import argparse
import json
import pathlib
import shutil
import sys
import tempfile
import time

import night_bars

ENTITIES = {"128x128": "Vision/RGB/small/cam", "640x480": "Vision/RGB/large/cam"}
MAX_LATE_SECONDS = 30
MAX_NIGHTS = 3

EXAMPLES = """Examples:
  short_nights.py build/release/bin/engram ../shared/data
  short_nights.py build/release/bin/engram ../shared/data --shares 0.5 0.25 --images 512 128
"""


class Days(night_bars.Store):
    """A store of several cameras."""

    def __init__(self, engram, recordings, images, work):
        super().__init__(engram, recordings, "day", work)
        for size, count in zip(ENTITIES, images):
            self.size, self.images, self.pieces = size, 0, 0
            self.add(count)

    @property
    def entity(self):
        return ENTITIES[self.size]


def consolidate(options, path, *limits):
    """The report of a night, with what it took by the clock."""
    start = time.monotonic()
    out, _, _ = night_bars.run(
        [options.engram, "consolidate", path, "--psnr", options.psnr, "--representation",
         options.representation, "--json", *limits])
    return json.loads(out), time.monotonic() - start


def measure(options, work):
    recordings = night_bars.Recordings(options.engram, options.recordings, max(options.images), work)
    day = Days(options.engram, recordings, options.images, work)
    whole = work / "whole.engram"
    shutil.copytree(day.path, whole)
    night_bars.tell("a night without an end")
    report, seconds = consolidate(options, whole)
    first = {one["entity"]: one for one in report["entities"]}
    result = {"whole_seconds": seconds, "nights": []}
    sizes = {name: one["images"]["kept_bytes"] / one["images"]["rows"] for name, one in first.items()}
    for share in options.shares:
        store = work / f"share-{share}.engram"
        shutil.copytree(day.path, store)
        kept = {name: [0, 0] for name in first}
        for number in range(1, options.max_nights + 1):
            budget = seconds * share
            night_bars.tell(f"night {number} of {share:g} of that time: {budget:.0f} s")
            report, took = consolidate(options, store, "--budget", f"{budget:.1f}s")
            waiting = {}
            for one in report["entities"]:
                if "skipped" in one:
                    waiting[one["entity"]] = one["skipped"]
                    continue
                waiting[one["entity"]] = one["waiting"]
                kept[one["entity"]][0] += one["images"]["kept_bytes"]
                kept[one["entity"]][1] += one["images"]["rows"]
            encoded = sum(one.get("snapshots", 0) for one in report["entities"])
            is_done = all(left in (0, "nothing new") for left in waiting.values())
            result["nights"].append(
                {"share": share, "night": number, "budget_seconds": budget, "seconds": took,
                 "waiting": waiting, "is_done": is_done, "encoded": encoded,
                 "rows": {name: rows for name, (_, rows) in kept.items()},
                 "notes": [note for one in report["entities"] for note in one.get("notes", [])],
                 "of_whole": {name: kept[name][0] / kept[name][1] / sizes[name]
                              for name in kept if kept[name][1]} if is_done else None})
            if is_done:
                break
        shutil.rmtree(store)
    return result


def show(result):
    """Whether the bars are reached."""
    print(f"everything in one night without an end: {result['whole_seconds']:.0f} s\n")
    rows = [["share", "night", "budget", "took", "encoded", "waits", "bytes of the whole night's"]]
    is_reached = True
    for night in result["nights"]:
        rows.append([f"{night['share']:g}", str(night["night"]), f"{night['budget_seconds']:.0f} s",
                     f"{night['seconds']:.0f} s", str(night["encoded"]),
                     ", ".join(str(left) for left in night["waiting"].values()),
                     ", ".join(f"{ratio:.3f}" for ratio in (night["of_whole"] or {}).values())])
        is_reached &= night["seconds"] <= night["budget_seconds"] + MAX_LATE_SECONDS
        is_reached &= night["encoded"] > 0
        if night["share"] == 0.5 and night["night"] == MAX_NIGHTS:
            is_reached &= night["is_done"]
    print(night_bars.table(rows))
    print(f"\n{'reached' if is_reached else 'MISSED'}: no night ends {MAX_LATE_SECONDS} s late or does "
          f"nothing, and half of the time does everything in {MAX_NIGHTS} nights")
    return is_reached


def arguments_of(words=None):
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", type=pathlib.Path, help="the program")
    parser.add_argument("recordings", help='folder with videos, anywhere below; "": none')
    parser.add_argument("--images", nargs=len(ENTITIES), type=int, default=[400, 200], metavar="N",
                        help="images of 128x128 and of 640x480 (400 200)")
    parser.add_argument("--shares", nargs="+", type=float, default=[0.5, 0.25, 5],
                        help="nights of so many times the time of everything (0.5 0.25 5)")
    parser.add_argument("--max-nights", type=int, default=8, help="nights of each share (8)")
    parser.add_argument("--psnr", type=float, default=35, help="min PSNR of each image, dB (35)")
    parser.add_argument("--representation", choices=["auto", "video"], default="video",
                        help="the form of images (video)")
    parser.add_argument("--work", type=pathlib.Path, help="folder for stores; else a temporary one")
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    return parser.parse_args(words)


def main():
    options = arguments_of()
    try:
        with tempfile.TemporaryDirectory(prefix="short_nights-", dir=options.work) as folder:
            result = measure(options, pathlib.Path(folder))
    except night_bars.Failed as failed:
        sys.exit(f"short_nights: {failed}")
    except KeyboardInterrupt:
        sys.exit(130)
    if options.json:
        options.json.write_text(json.dumps(result, indent=1))
    return 0 if show(result) else 1


if __name__ == "__main__":
    sys.exit(main())
