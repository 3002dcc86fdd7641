#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Many entities, and answers of any size: what a store and a server take for them.

100,000 entities of one snapshot each are told to a server, which is then ended: how long that takes,
what the store takes on the disk beside its journal, and how long `info` and `check` take. All of
450,000 snapshots are asked for at once: what clients and the server take in RAM, and what the server
keeps. A million entities go through a working memory of 64 MiB.

RAM of a server is what it has beside what it had before it was asked; that of a client is all that it
has at most, and what it has beside a client that asks for nearly nothing.
"""

from __future__ import annotations

import argparse
import json
import resource
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

EXAMPLES = """Examples:
  make many-bars
  python3 -m experiments.many --engram build/release/bin/engram --only entities
"""
START = 1_600_000_000 * 10**9
MB = 1e6


def resident(pid: int, what: str = "VmRSS") -> float:
    """MB of RAM of a process, or of its peak (VmHWM)."""
    status = Path(f"/proc/{pid}/status").read_text()
    return int(status.split(what + ":")[1].split()[0]) * 1024 / MB


def size_of(folder: Path) -> float:
    return sum(f.stat().st_size for f in folder.rglob("*") if f.is_file()) / MB


class Bars:
    def __init__(self, program: Path, folder: Path) -> None:
        self.program, self.folder = program, folder
        self.missed = 0
        self.rows: list[dict[str, object]] = []

    def told(self, what: str, found: float, bar: float | None, unit: str) -> None:
        is_missed = bar is not None and found > bar
        self.missed += is_missed
        self.rows.append({"what": what, "found": round(found, 3), "bar": bar, "unit": unit})
        said = "" if bar is None else f"   bar {bar:g}: {'MISSED' if is_missed else 'reached'}"
        print(f"{what:<58} {found:9.2f} {unit}{said}", flush=True)

    def run(self, *words: object, out: Path | None = None) -> tuple[float, float]:
        """Seconds and MB of RAM of a command that succeeds."""
        taken = self.folder / "time"
        with open(out or "/dev/null", "w") as stdout:
            begun = time.monotonic()
            done = subprocess.run(
                ["/usr/bin/time", "-o", taken, "-f", "%M", self.program, *map(str, words)],
                stdout=stdout, stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL)
        if done.returncode != 0:
            sys.exit(f"engram {words[0]} failed: {done.stderr[-500:]}")
        return time.monotonic() - begun, int(taken.read_text()) * 1024 / MB

    def processor_ms(self, words: list[str]) -> float:
        """Of a command that succeeds, with its threads: the median of nine runs."""
        taken = []
        for _ in range(9):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run([self.program, *words], check=True, stdout=subprocess.DEVNULL)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            taken.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        return statistics.median(taken) * 1e3

    def serve(self, store: Path, *options: str) -> tuple[subprocess.Popen[bytes], str]:
        socket = self.folder / "socket"
        server = self.started(socket, store, "--listen", f"unix:{socket}", "--no-system-state",
                              *options)
        return server, f"unix:{socket}"

    def started(self, socket: Path, *words: object) -> subprocess.Popen[bytes]:
        """'engram serve' with these words, once it listens."""
        socket.unlink(missing_ok=True)
        with open(self.folder / "server.log", "w") as log:
            server = subprocess.Popen([self.program, "serve", *map(str, words)],
                                      stdout=subprocess.DEVNULL, stderr=log)
        while not socket.exists():
            if server.poll() is not None:
                sys.exit((self.folder / "server.log").read_text())
            time.sleep(0.05)
        return server

    @staticmethod
    def end(server: subprocess.Popen[bytes]) -> float:
        begun = time.monotonic()
        server.send_signal(signal.SIGTERM)
        server.wait()
        return time.monotonic() - begun

    def things(self, count: int) -> Path:
        """One snapshot each of so many things."""
        path = self.folder / "things"
        with open(path, "w") as lines:
            for i in range(count):
                data = {"name": f"thing {i}", "height": i * 0.25, "pose": [i * 0.5, 1.0, 2.0]}
                name = f"Objects/Things/kitchen{i % 50}/thing{i:07}"
                lines.write(json.dumps({"entity": name, "data": data}) + "\n")
        return path

    def entities(self, count: int) -> None:
        store = self.folder / "entities.engram"
        server, at = self.serve(store, "--durability", "journal")
        self.run("commit", "--server", at, "--lines", self.things(count))
        journal = size_of(store / "journal")
        self.told(f"{count:,} entities: end of a server", self.end(server), 10, "s")
        self.told("store beside its journal", size_of(store) / journal, 3, "times")
        self.told("info", self.run("info", store)[0], 1, "s")
        self.told("info --json", self.run("info", store, "--json")[0], None, "s")
        seconds, ram = self.run("check", store)
        self.told("check", seconds, 10, "s")
        self.told("RAM of check", ram, None, "MB")
        few = self.folder / "few.engram"
        self.run("commit", "--db", few, "--lines", self.things(count // 100))
        one = "Objects/Things/kitchen7/thing0000007"
        asks = {"query": ("query", "{}", f"{one} @ latest"),
                "commit": ("commit", "--db", "{}", one, "--data", '{"height": 0.5}')}
        for what, words in asks.items():
            # What one thing takes must not depend on those that nobody asks for.
            of_few, of_all = (self.processor_ms([w.replace("{}", str(of)) for w in words])
                              for of in (few, store))
            self.told(f"{what} of one of them", of_all, None, "ms of a processor")
            self.told(f"  beside {what} of one of {count // 100:,}", of_all / of_few, 1.25, "times")

    def history(self, count: int) -> None:
        store = self.folder / "history.engram"
        with open(self.folder / "history", "w") as lines:
            for i in range(count):
                lines.write(json.dumps({
                    "entity": f"Robot/State/arm/joint{i % 10}", "time": START + i * 1_000_000,
                    "data": {"name": f"state {i % 7}", "height": i * 0.25,
                             "pose": [i * 0.5, 1.0, 2.0]}}) + "\n")
        self.run("commit", "--db", store, "--lines", self.folder / "history")
        rest = self.run("query", store, "?ids Robot/State/arm/joint1 @ latest")[1]
        self.told("client at rest: libraries", rest, None, "MB")
        answer = self.folder / "answer"
        for form in ((), ("--json",)):
            seconds, ram = self.run("query", store, "Robot @ all", *form, out=answer)
            name = " ".join(("query of a store", *form))
            self.told(f"{count:,} snapshots, {name}: client", ram, 100, "MB")
            self.told("  beside one at rest", ram - rest, 100, "MB")
            self.told(f"  its {answer.stat().st_size / MB:.0f} MB", seconds, None, "s")
        self.history_by_names(store, count, rest)
        server, at = self.serve(store)
        self.run("query", "--server", at, "Robot @ latest")
        before = resident(server.pid)
        seconds, ram = self.run("query", "--server", at, "Robot @ all", "--json", out=answer)
        self.told(f"{count:,} snapshots, query of a server: client", ram, 100, "MB")
        self.told("  beside one at rest", ram - rest, 100, "MB")
        self.told("  server, at most", resident(server.pid, "VmHWM") - before, 100, "MB")
        time.sleep(1)
        self.told("  server, afterwards", resident(server.pid) - before, 100, "MB")
        self.told("  its time", seconds, None, "s")
        self.end(server)

    def history_by_names(self, store: Path, count: int, rest: float) -> None:
        """The same of a server that a name system knows."""
        names, socket = (self.folder / one for one in ("names", "socket"))
        config = self.folder / "robot.yaml"
        config.write_text(json.dumps({
            "names": {"listen": f"unix:{names}"},
            "servers": [{"name": "body", "memories": ["Robot"], "listen": [f"unix:{socket}"],
                         "store": str(store)}]}))
        server = self.started(socket, "--config", config)
        answer = self.folder / "answer"
        ram = self.run("query", "--names", f"unix:{names}", "Robot @ all", "--json", out=answer)[1]
        self.told(f"{count:,} snapshots, query by names: client", ram, 100, "MB")
        self.told("  beside one at rest", ram - rest, 100, "MB")
        self.end(server)

    def memory(self, count: int) -> None:
        limit = 64
        store = self.folder / "memory.engram"
        server, at = self.serve(store, "--bytes", f"{limit}MiB")
        before = resident(server.pid)
        # The last ones are refused: a server knows a million entities at most.
        self.run("commit", "--server", at, "--lines", self.things(count))
        time.sleep(2)
        after = resident(server.pid)
        info = self.folder / "info"
        self.run("info", "--server", at, "--json", out=info)
        held = json.loads(info.read_text())["figures"]
        self.told(f"{count:,} entities: told working memory", held["memory_bytes"] / MB, None, "MB")
        self.told("entities in it", held["memory_entities"], None, "")
        self.told("RAM of the server", after - before, None, "MB")
        self.told("RAM besides working memory, an entity",
                  (after - before - held["memory_bytes"] / MB) * MB / count, None, "bytes")
        self.told("end of the server", self.end(server), None, "s")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parts = {"entities": 100_000, "history": 450_000, "memory": 990_000}
    parser.add_argument("--engram", type=Path, required=True, help="the program")
    parser.add_argument("--only", nargs="+", choices=list(parts), default=list(parts))
    parser.add_argument("--share", type=float, default=1.0, help="of the numbers above")
    parser.add_argument("--work", type=Path, help="folder to work in; else a temporary one")
    parser.add_argument("--json", action="store_true", help="the figures as JSON, too")
    options = parser.parse_args()
    folder = options.work or Path(tempfile.mkdtemp(prefix="engram-many-"))
    folder.mkdir(parents=True, exist_ok=True)
    bars = Bars(options.engram.resolve(), folder)
    try:
        for part in options.only:
            getattr(bars, part)(max(int(parts[part] * options.share), 2000))
    finally:
        if options.work is None:
            shutil.rmtree(folder)
    if options.json:
        print(json.dumps(bars.rows, indent=2))
    return 1 if bars.missed else 0


if __name__ == "__main__":
    sys.exit(main())
