#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How does the viewer follow a robot that records?

A memory server, a robot that commits joints and images to it, `engram view` of the server and
Chromium that follows. Prints how long it takes from a commit to what a person sees of it, and how
the memory of the browser and of the gateway grows. A commit carries the time at which it was made,
so the page alone tells how old what it shows is; that needs commits that are further apart than
what is measured, as they are at 3 a second.
"""

from __future__ import annotations

import argparse
import base64
import json
import math
import pathlib
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "viewer"))
from viewing import Viewed, resident_mb  # noqa: E402

EXAMPLES = """Examples:
  live_bars.py build/release/bin/engram build/release/viewer/web
  live_bars.py build/release/bin/engram build/release/viewer/web --seconds 3600 --json live.json
"""
JOINTS = "RobotState/Proprioception/robot/joints"
CAMERA = "Vision/RGB/head/left"
HERE = pathlib.Path(__file__).resolve().parent
SIDE = 128


def joints_at(seconds: float) -> dict[str, object]:
    return {"positions": [math.sin(seconds * (0.2 + 0.01 * i)) for i in range(43)]}


def image_at(count: int) -> dict[str, object]:
    row = bytes((3 * x + 7 * count) % 256 for x in range(3 * SIDE))
    return {"$ndarray": {"type": "uint8", "shape": [SIDE, SIDE, 3],
                         "base64": base64.b64encode(row * SIDE).decode()}}


class Robot:
    """Commits joints, and images less often, until it is stopped. Threading: one other thread."""

    def __init__(self, engram: str, endpoint: str, joints_hz: int, images_hz: int) -> None:
        self.program = subprocess.Popen([engram, "commit", "--server", endpoint, "--lines", "-"],
                                        stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        self.joints_hz, self.images_hz = joints_hz, images_hz
        self.committed = 0
        self.is_stopped = threading.Event()
        self.thread = threading.Thread(target=self.commit)
        self.thread.start()

    def commit(self) -> None:
        assert self.program.stdin
        begin = time.monotonic()
        every = max(1, round(self.joints_hz / self.images_hz))
        while not self.is_stopped.wait(max(0.0, begin + self.committed / self.joints_hz
                                           - time.monotonic())):
            lines = []
            if self.committed % every == 0:
                lines.append({"entity": CAMERA, "time": str(time.time_ns()),
                              "data": {"image": image_at(self.committed)}})
            lines.append({"entity": JOINTS, "time": str(time.time_ns()),
                          "data": joints_at(self.committed / self.joints_hz)})
            self.program.stdin.write("".join(json.dumps(line) + "\n" for line in lines))
            self.program.stdin.flush()
            self.committed += 1

    def stop(self) -> None:
        self.is_stopped.set()
        self.thread.join()
        assert self.program.stdin
        self.program.stdin.close()
        self.program.wait(60)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engram", help="the program")
    parser.add_argument("web", help="where the build made the page: build/release/viewer/web")
    parser.add_argument("--seconds", type=int, default=60, help="how long the page follows")
    parser.add_argument("--joints", type=int, default=3, help="commits of joints per second")
    parser.add_argument("--images", type=int, default=3, help="images per second")
    parser.add_argument("--json", type=pathlib.Path, help="writes all figures here")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        endpoint = f"unix:{folder}/engram.sock"
        server = subprocess.Popen([asked.engram, "serve", f"{folder}/live.engram", "--listen",
                                   endpoint, "--no-system-state", "--json"],
                                  stdout=subprocess.PIPE, text=True)
        assert server.stdout
        server.stdout.readline()
        robot = Robot(asked.engram, endpoint, asked.joints, asked.images)
        try:
            time.sleep(3)  # There is something to see.
            with Viewed(asked.engram, "--server", endpoint) as viewed:
                watched = subprocess.Popen(
                    ["node", str(HERE / "page_bars.mjs"), str(pathlib.Path(asked.web).resolve()),
                     "live", viewed.url, str(asked.seconds)], stdout=subprocess.PIPE, text=True)
                gateway = []
                while watched.poll() is None:
                    gateway.append(resident_mb(viewed.process.pid))
                    time.sleep(min(10.0, asked.seconds / 20))
                assert watched.stdout
                seen = json.loads(watched.stdout.read())
        finally:
            robot.stop()
            server.send_signal(signal.SIGINT)
            server.wait(60)
    for name in ("clock", "value", "image"):
        ages = sorted(seen["ages"][name])
        print(f"from a commit to its {name:6} on the page: p50 {statistics.median(ages):6.1f} ms, "
              f"p95 {ages[int(0.95 * len(ages))]:6.1f} ms, {len(ages)} of them (bar: p50 50 ms)")
    heap = seen["heap_mb"]
    third = max(1, len(heap) // 3)
    print(f"heap of the page after collection: {heap[0]:.1f} MB at first, {heap[third]:.1f} after a "
          f"third, {heap[-1]:.1f} at the end, {max(heap):.1f} at most (bar 300)")
    third = len(gateway) // 3
    print(f"gateway: {gateway[0]:.0f} MB at first, {gateway[third]:.0f} after a third, "
          f"{gateway[-1]:.0f} at the end, {max(gateway):.0f} at most (bar 500)")
    print(f"the robot committed {robot.committed} times in all")
    if asked.json:
        asked.json.write_text(json.dumps({**seen, "gateway_mb": gateway}, indent=1) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
