#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How quick is the viewer?

Asks a running `engram view` as the page does, and does in Chromium what a person does: opens a
memory, steps through images, scrubs, looks into the future, scrolls names. Prints medians beside
the bars of docs/viewer.md. Times are those of a machine with its load; each is told with its 99th
percentile.
"""

from __future__ import annotations

import argparse
import http.client
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.parse
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "viewer"))
from viewing import Viewed, make_kitchen, resident_mb, run  # noqa: E402

EXAMPLES = """Examples:
  viewer_bars.py build/release/bin/engram build/release/viewer/web
  viewer_bars.py build/release/bin/engram build/release/viewer/web --kitchen demo/robot.engram
  viewer_bars.py build/release/bin/engram build/release/viewer/web --scale bars/scale/store
"""
STEREO = "Vision/RGB/head/stereo"
HERE = pathlib.Path(__file__).resolve().parent


class Bars:
    """Figures beside their bars, in the order in which they were measured."""

    def __init__(self) -> None:
        self.rows: list[dict[str, Any]] = []

    def add(self, name: str, times_ms: list[float], bar_ms: float | None = None) -> None:
        times = sorted(times_ms)
        row = {"name": name, "p50_ms": statistics.median(times),
               "p99_ms": times[min(len(times) - 1, int(0.99 * len(times)))], "count": len(times),
               "bar_ms": bar_ms}
        self.rows.append(row)
        bar = "" if bar_ms is None else f"{bar_ms:g}"
        verdict = "" if bar_ms is None else "kept" if row["p50_ms"] <= bar_ms else "missed"
        print(f"{name:58} {row['p50_ms']:9.2f} {row['p99_ms']:9.2f} {bar:>7} {verdict}", flush=True)


class Asking:
    """One connection that is kept, as a browser keeps it."""

    def __init__(self, viewed: Viewed) -> None:
        self.viewed = viewed
        self.connection = http.client.HTTPConnection(viewed.host, viewed.port, timeout=120)

    def timed(self, where: str, **parameters: Any) -> tuple[float, bytes, dict[str, str]]:
        """Milliseconds until the whole answer is there."""
        target = where + "?" + urllib.parse.urlencode(parameters, doseq=True)
        begin = time.perf_counter()
        self.connection.request("GET", target, headers={"Cookie": self.viewed.cookie})
        response = self.connection.getresponse()
        body = response.read()
        took = 1e3 * (time.perf_counter() - begin)
        if response.status != 200:
            raise SystemExit(f"{target}: {response.status} {body[:300]!r}")
        return took, body, {key.lower(): value for key, value in response.getheaders()}


def page(web: str, *words: Any) -> Any:
    """What page_bars.mjs measured."""
    done = subprocess.run(["node", str(HERE / "page_bars.mjs"), web, *map(str, words)],
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"page_bars.mjs {words[0]}: {done.stderr[-2000:]}")
    return json.loads(done.stdout)


def kitchen_bars(bars: Bars, engram: str, web: str, store: pathlib.Path, steps: int) -> None:
    ids = json.loads(run(engram, "query", "--unnoted", str(store), f"?ids {STEREO} @ all",
                         "--json"))["ids"][:steps]
    with Viewed(engram, str(store)) as viewed:
        asking = Asking(viewed)
        scattered = [ids[(i * 37) % len(ids)] for i in range(len(ids))]
        for name, form, order, as_, bar in (
                ("image: recorded, in order, JPEG", "recorded", ids, "jpeg", 10),
                ("image: recorded, scattered, PNG", "recorded", scattered, "png", 10),
                ("image: latent, in order, JPEG", "latent", ids, "jpeg", 15),
                ("image: latent, scattered, JPEG", "latent", scattered, "jpeg", 30)):
            asking.timed("/api/image", id=order[0], path="image", form=form)
            bars.add(name, [asking.timed("/api/image", id=one, path="image", form=form,
                                         **{"as": as_})[0] for one in order], bar)
        joints = "RobotState/Proprioception/robot/joints"
        last = int(viewed.json("/api/info")["last"])
        for at in (last + 200_000_000, last + 400_000_000):
            asking.timed("/api/moment", entity=joints, at=at, which="predict")
        bars.add("prediction of joints, learned", [
            asking.timed("/api/moment", entity=joints, at=last + (i + 1) * 37_000_000,
                         which="predict")[0] for i in range(min(steps, 50))], 100)
        url = viewed.url
        bars.add("page: key to all forms of the next image",
                 page(web, "images", url, "next", steps), 80)
        bars.add("page: key to all forms of the tenth image from here",
                 page(web, "images", url, "scattered", min(steps, 20)), 80)
        bars.add("page: key to the next predicted value", page(web, "predict", url, 20), 100)
        scrubbed = page(web, "scrub", url, 8)
        panels = scrubbed["panels"]
        bars.add(f"page: frames while scrubbing {panels.count('images')} images, "
                 f"{panels.count('plot')} plots", scrubbed["frames"], 16.8)
        print(f"gateway's memory after all: {resident_mb(viewed.process.pid):.0f} MB (bar 500)")


def scale_bars(bars: Bars, engram: str, web: str, store: pathlib.Path, rounds: int) -> None:
    opened = page(web, "open", engram, str(store.resolve()), rounds)
    bars.add("command to its address", [one["command"] for one in opened])
    bars.add("command to a timeline with counts", [one["usable"] for one in opened], 1000)
    with Viewed(engram, str(store)) as viewed:
        asking = Asking(viewed)
        info = viewed.json("/api/info")
        entities = viewed.json("/api/find", text="", max=20)["found"]
        span = {"from": int(info["first"]), "to": int(info["last"]) + 1, "pixels": 2000}
        bars.add(f"density, {len(entities)} lanes x 2,000, first",
                 [asking.timed("/api/density", entity=entities, **span)[0]])
        bars.add(f"density, {len(entities)} lanes x 2,000, {info['snapshots']} snapshots", [
            asking.timed("/api/density", entity=entities, **span)[0] for _ in range(30)], 30)
        path = next(one["path"] for one in viewed.json("/api/members", entity=entities[0])["members"]
                    if one["kind"] == "number")
        took, _, headers = asking.timed("/api/series", entity=entities[0], path=path, **span)
        bars.add("series, first look, coarse", [took], 1000)
        print(f"  it read {headers['x-engram-read']} of {headers['x-engram-total']} snapshots")
        began = time.perf_counter()
        while int(headers["x-engram-read"]) < int(headers["x-engram-total"]):
            _, _, headers = asking.timed("/api/series", entity=entities[0], path=path, budget=5000,
                                         **span)
            if time.perf_counter() - began > 120:
                break
        bars.add("series of all its numbers, again",
                 [asking.timed("/api/series", entity=entities[0], path=path, **span)[0]
                  for _ in range(10)], 50)
        print(f"gateway's memory after all: {resident_mb(viewed.process.pid):.0f} MB (bar 500)")


def names_bars(bars: Bars, engram: str, web: str, folder: pathlib.Path, count: int) -> None:
    """A memory of many names, each with a number."""
    lines = folder / "names"
    with lines.open("w") as out:
        for i in range(count):
            out.write(json.dumps({"entity": f"Many/Names{i // 500:03}/Rooms{i // 50:03}/thing{i:05}",
                                  "data": {"x": float(i)}}) + "\n")
    store = folder / "names.engram"
    run(engram, "commit", "--db", str(store), "--lines", str(lines))
    with Viewed(engram, str(store)) as viewed:
        bars.add(f"page: frames while {count} names scroll", page(web, "names", viewed.url, 6), 16.8)


def commit_bars(bars: Bars, engram: str, folder: pathlib.Path, rounds: int) -> None:
    """Simulates a kitchen as fast as it can, with and without a viewer that looks at it. What counts
    is the time of processors that the recording program took: it shares them with the viewer here."""
    took: dict[bool, list[float]] = {False: [], True: []}
    for i in range(rounds):
        for has_viewer in ((False, True), (True, False))[i % 2]:
            store = folder / f"commits{i}{has_viewer:d}.engram"
            program = subprocess.Popen([engram, "simulate", "kitchen", str(store), "--fast",
                                        "--seconds", "60"], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
            if has_viewer:
                look_until_over(engram, store, program)
            _, _, usage = os.wait4(program.pid, 0)
            took[has_viewer].append(usage.ru_utime + usage.ru_stime)
    ratios = [with_ / without for with_, without in zip(took[True], took[False])]
    bars.rows.append({"name": "processor time of recording with a viewer open, beside without",
                      "ratios": ratios, "bar": 1.02})
    print(f"recording with a viewer that looks 4 times a second takes {statistics.median(ratios):.3f} "
          f"of the processor time without (bar 1.02; {min(ratios):.3f} to {max(ratios):.3f})")


def is_running(program: subprocess.Popen[bytes]) -> bool:
    """Without taking its end, whose usage counts."""
    return os.waitid(os.P_PID, program.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None


def look_until_over(engram: str, store: pathlib.Path, program: subprocess.Popen[bytes]) -> None:
    while is_running(program) and not (store / "MANIFEST.json").exists():
        time.sleep(0.05)
    with Viewed(engram, str(store)) as viewed:
        while is_running(program):
            info = viewed.json("/api/info")
            if info.get("first"):
                viewed.get("/api/density", entity=STEREO, **{"from": info["first"]},
                           to=int(info["last"]) + 1, pixels=2000)
            time.sleep(0.25)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", help="the program")
    parser.add_argument("web", help="where the build made the page: build/release/viewer/web")
    parser.add_argument("--kitchen", type=pathlib.Path,
                        help="a consolidated kitchen; otherwise one of 20 s is made")
    parser.add_argument("--scale", type=pathlib.Path,
                        help="a large store, as `make store-scale BARS=--keep` leaves one")
    parser.add_argument("--steps", type=int, default=100, help="images and predictions")
    parser.add_argument("--rounds", type=int, default=5, help="how often a memory is opened")
    parser.add_argument("--names", type=int, default=5000, help="names that scroll; 0: none")
    parser.add_argument("--json", type=pathlib.Path, help="writes all figures here")
    asked = parser.parse_args()
    web = str(pathlib.Path(asked.web).resolve())
    bars = Bars()
    print(f"{'what':58} {'p50 ms':>9} {'p99 ms':>9} {'bar':>7}")
    with tempfile.TemporaryDirectory() as folder:
        kitchen = asked.kitchen or make_kitchen(asked.engram, pathlib.Path(folder), 20, True)
        kitchen_bars(bars, asked.engram, web, kitchen, asked.steps)
        if asked.names:
            names_bars(bars, asked.engram, web, pathlib.Path(folder), asked.names)
        commit_bars(bars, asked.engram, pathlib.Path(folder), asked.rounds)
        if asked.scale:
            scale_bars(bars, asked.engram, web, asked.scale, asked.rounds)
        else:
            print("a large memory: not measured, needs --scale")
    if asked.json:
        asked.json.write_text(json.dumps({"bars": bars.rows}, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
