#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Attacks on a store and on the programs that open it, on this machine alone.

Each attack prints what was promised and what was found. The exit code is 1 if a promise is broken.
Times are those of the wall clock, so a busy machine can only make them look worse.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from experiments.hostile.membership import area_under_curve, networks_of, psnr_db, squares

EXAMPLES = """Examples:
  make hostile
  python3 -m experiments.hostile --engram build/release/bin/engram --only names interrupts
"""
CAMERA = "Vision/RGB/head/cam"
EVIL = "cup\x1b]0;owned\x07\nfault: forged\x9b2J\u202egnp"
START = 1_600_000_000 * 10**9
STEP = 100_000_000
SECONDS = 1.0


class Attacks:
    def __init__(self, program: Path, folder: Path, snapshots: int) -> None:
        self.program, self.folder, self.snapshots = program, folder, snapshots
        self.results: list[dict[str, object]] = []

    def told(self, attack: str, promise: str, found: str, is_kept: bool) -> None:
        self.results.append(
            {"attack": attack, "promise": promise, "found": found, "kept": is_kept}
        )
        print(f"{'kept  ' if is_kept else 'BROKEN'}  {attack}: {promise}: {found}", flush=True)

    def run(self, *words: object, seconds: float = 60) -> subprocess.CompletedProcess[str]:
        words_of = [str(self.program), *map(str, words)]
        return subprocess.run(words_of, capture_output=True, text=True, timeout=seconds,
                              stdin=subprocess.DEVNULL, errors="surrogateescape")

    def store(self, name: str, count: int = 40, entity: str = CAMERA) -> Path:
        import engram

        path = self.folder / f"{name}.engram"
        shutil.rmtree(path, ignore_errors=True)
        y, x, _ = np.mgrid[0:48, 0:64, 0:3]
        with engram.record(path) as recorder:
            for i in range(count):
                image = ((x + 3 * y + 5 * i) % 97 + 60).astype(np.uint8)
                recorder.commit(entity, {"image": image}, START + i * STEP)
        return path

    def names(self) -> None:
        """Names that give orders to a terminal, or look like lines of the program."""
        store = self.store("names", 3, f"Vision/RGB/head/{EVIL}")
        for words in (["info"], ["ls"], ["check"], ["query", "@ all"], ["models"],
                      ["forget", "Vision", "--dry-run"], ["consolidate", "--dry-run"], ["eval"],
                      ["recover", "-o", self.folder / "recovered.engram"]):
            done = self.run(words[0], store, *words[1:])
            text = done.stdout + done.stderr
            bad = [c for c in text if (ord(c) < 32 and c not in "\n\t") or 127 <= ord(c) < 160
                   or c == "\u202e"]
            forged = [line for line in text.splitlines() if line.startswith("fault: forged")]
            self.told(f"names in {words[0]}", "no control characters, no forged lines",
                      f"{len(bad)} and {len(forged)}", not bad and not forged)
        found = json.loads(self.run("info", store, "--json").stdout)
        self.told("names in JSON", "exact", repr(found["entities"][0]["id"][-12:]),
                  found["entities"][0]["id"].endswith(EVIL))

    def pipes(self) -> None:
        """A named pipe in the place of each kind of file."""
        for victim in ("MANIFEST.json", "segments/000001.h5", "journal/000009.log"):
            store = self.store("pipes")
            (store / victim).unlink(missing_ok=True)
            os.mkfifo(store / victim)
            for words in (["check", store], ["info", store], ["query", store, "@ all"]):
                begin = time.monotonic()
                try:
                    code = str(self.run(*words, seconds=10).returncode)
                except subprocess.TimeoutExpired:
                    code = "none"
                took = time.monotonic() - begin
                self.told(f"a pipe as {victim}, {words[0]}", "ends at once",
                          f"exit code {code} after {took:.1f} s", code != "none")

    def future(self) -> None:
        """A snapshot from the end of time."""
        import engram

        store = self.store("future")
        try:
            with engram.record(store) as recorder:
                recorder.commit(CAMERA, {"image": np.zeros((48, 64, 3), np.uint8)}, 2**63 - 1)
            found = "taken"
        except engram.errors.EngramError as error:
            found = str(error)
        self.told("a time of 2262", "refused with the reason", found, "ahead of the clock" in found)

    def journals(self) -> None:
        """A journal that is cut anywhere."""
        import engram

        store = self.folder / "journals.engram"
        shutil.rmtree(store, ignore_errors=True)
        config = self.folder / "every.yaml"
        config.write_text("store: {durability: every}\n")
        copy = self.folder / "unsealed.engram"
        shutil.rmtree(copy, ignore_errors=True)
        with engram.record(store, config=config) as recorder:
            for i in range(20):
                recorder.commit("Speech/Commands/human/text", {"text": "x" * 100}, START + i * STEP)
            shutil.copytree(store, copy)
        (journal,) = copy.glob("journal/*.log")
        whole = journal.read_bytes()
        missed = 0
        for size in range(0, len(whole) - 8, max(1, len(whole) // 40)):
            journal.write_bytes(whole[:size])
            missed += self.run("check", copy).returncode == 0
        self.told("a journal that is cut", "each cut of what was forced to the disk is a fault",
                  f"{missed} cuts were called whole", missed == 0)

    def model(self) -> None:
        """A model whose bytes are damaged."""
        store = self.store("model")
        self.run("consolidate", store, "--representation", "video", "--training", "1s", seconds=300)
        (model,) = store.glob("models/*.h5")
        content = bytearray(model.read_bytes())
        content[len(content) // 2 :] = bytes(len(content) - len(content) // 2)
        model.write_bytes(content)
        for what, words in (("latents", [f"{CAMERA} @ all", "--prefer", "latent"]),
                            ("a prediction", [f"{CAMERA} @ +200ms"])):
            done = self.run("query", store, *words)
            self.told(f"a damaged model, {what}", "what was recorded answers, with a warning",
                      f"exit code {done.returncode}", done.returncode == 0 and "warning" in done.stderr)

    def floods(self) -> None:
        """Streams that are opened and reset at once (HTTP/2 rapid reset), beside another client."""
        self._floods("3 floods of 120,000 streams", lambda port: _flood(port, 120_000), 300)

    def headers(self) -> None:
        """A request whose headers never end (CVE-2023-33953), beside another client."""
        self._floods("3 requests with 2 GB of headers", lambda port: _headers(port, 2 << 30), 800)

    def _floods(self, name: str, attack: Callable[[int], None], max_mb: int) -> None:
        store = self.store("floods")
        server = subprocess.Popen([self.program, "serve", store, "--listen", "127.0.0.1:0"],
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            port = _port_of(server)
            before = _resident_mb(server.pid)
            highest = before
            slowest = 0.0
            for _ in range(3):
                flood = threading.Thread(target=attack, args=(port,))
                flood.start()
                while flood.is_alive():
                    highest = max(highest, _resident_mb(server.pid))
                    begin = time.monotonic()
                    done = self.run("query", "--server", f"127.0.0.1:{port}", f"{CAMERA} @ latest")
                    slowest = max(slowest, time.monotonic() - begin)
                    if done.returncode != 0:
                        slowest = float("inf")
            until = time.monotonic() + 15
            while (after := _resident_mb(server.pid)) > before + 150 and time.monotonic() < until:
                time.sleep(0.2)
            self.told(name, f"at most {max_mb} MB more, and given back",
                      f"{before} MB before, {highest} at most, {after} after",
                      highest <= before + max_mb and after <= before + 150)
            self.told(f"{name}, another client", "is answered within 5 s", f"{slowest:.1f} s",
                      slowest <= 5)
        finally:
            server.send_signal(signal.SIGTERM)
            server.wait(timeout=60)

    def erasure(self) -> None:
        """Images that are erased, in each form; the program's own answers and files are searched."""
        import engram

        canaries = list(range(2, 150, 3))
        for form, options in {"recorded": None, "video": ["video"], "latents": ["latents"]}.items():
            store = self.store(f"erased-{form}", 150)
            noise = np.random.default_rng(1)
            images = {}
            with engram.record(store) as recorder:
                for at in canaries:
                    squares = noise.choice([10, 245], (6, 8, 3)).repeat(8, 0).repeat(8, 1)
                    images[at] = squares.astype(np.uint8)
                    recorder.commit(CAMERA, {"image": images[at]}, START + at * STEP)
            if options:
                self.run("consolidate", store, "--representation", *options, "--training", "2s",
                         "--drop-raw", "--grace", "0s", seconds=300)
            ids = [f"{CAMERA} @ {_text_of(START + at * STEP)}" for at in canaries]
            done = self.run("forget", store, *ids, "--erase", "--yes", "--json", seconds=300)
            erased = json.loads(done.stdout)["done"]["snapshots"] if done.returncode == 0 else 0
            with engram.open(store) as memory:
                found = [np.asarray(snapshot.value["image"], float) for snapshot in memory[CAMERA]]
            alike = [10 * np.log10(255**2 / max(1e-9, ((image - canary) ** 2).mean()))
                     for image in found for canary in images.values()]
            is_whole = self.run("check", store, "--deep").returncode == 0
            self.told(f"erasing {len(canaries)} of 150 images, {form}",
                      "no answer is like one (below 12 dB), all else stays",
                      f"{erased} erased, {len(found)} stay, the most alike has {max(alike):.1f} dB",
                      erased == len(canaries) and len(found) == 150 - erased
                      and max(alike) < 12 and is_whole)

    def membership(self) -> None:
        """Models are asked for images that were erased, beside one that never saw them."""
        random = np.random.default_rng(7)
        seen, others = squares(random, 100), squares(random, 1000)
        ordinary, repeats = 60, 3
        times = [START + (ordinary + i) * STEP for i in range(repeats * len(seen))]
        night = ["--representation", "latents", "--training", "60s", "--psnr", "20", "--force"]
        import engram

        stores = {name: self.store(name, ordinary) for name in ("saw", "never-saw")}
        with engram.record(stores["saw"]) as recorder:
            for at, image in zip(times, np.tile(seen, (repeats, 1, 1, 1)), strict=True):
                recorder.commit(CAMERA, {"image": image}, at)
        for store in stores.values():
            self.run("consolidate", store, *night, seconds=600)
        control = networks_of(stores["saw"], CAMERA)
        if not control:
            self.told("membership", "a network is trained", "none was", False)
            return
        before = area_under_curve(psnr_db(control[-1], seen), psnr_db(control[-1], others))
        span = f"{_text_of(times[0])}..{_text_of(times[-1])}"
        done = self.run("forget", stores["saw"], f"{CAMERA} @ {span}",
                        "--erase", "--yes", seconds=600)
        kept = [f"v{model.version}" for model in networks_of(stores["saw"], CAMERA)]
        self.told("models that saw what is erased", "none stays", f"{kept or 'none'}",
                  done.returncode == 0 and not kept)
        self.run("consolidate", stores["saw"], *night, seconds=600)
        trained, never = (networks_of(stores[name], CAMERA)[-1] for name in ("saw", "never-saw"))
        found, wanted = psnr_db(trained, seen), psnr_db(never, seen)
        area = area_under_curve(found, psnr_db(trained, others))
        self.told("membership in the next model", "area under the curve at most 0.55",
                  f"{area:.3f}; of the model that saw them {before:.3f}", area <= 0.55)
        self.told("erased images in the next model", "within 0.5 dB of one that never saw them",
                  f"{found.mean():.2f} and {wanted.mean():.2f} dB",
                  abs(found.mean() - wanted.mean()) <= 0.5)

    def interrupts(self) -> None:
        """Ctrl-C in the middle of each command, on a store that keeps it busy."""
        store = self.store("interrupts", self.snapshots)
        commands = {
            "info": [store], "check": [store, "--deep"], "query": [store, "@ all", "--json"],
            "models": [store], "forget": [store, "Vision @ all", "--dry-run"],
            "consolidate": [store, "--representation", "video"],
            "export": [store, "Vision @ all", "--to", "mp4", "-o", self.folder / "videos"],
            "recover": [store, "-o", self.folder / "recovered.engram"], "compact": [store],
        }
        for name, words in commands.items():
            worst, codes = 0.0, set()
            for moment in (0.3, 0.6, 1.0, 2.0):
                for path in (self.folder / "videos", self.folder / "recovered.engram",
                             self.folder / "recovered.engram.unfinished"):
                    shutil.rmtree(path, ignore_errors=True)
                process = subprocess.Popen([self.program, name, *map(str, words)],
                                           stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                time.sleep(moment)
                process.send_signal(signal.SIGINT)
                begin = time.monotonic()
                codes.add(process.wait(timeout=120))
                worst = max(worst, time.monotonic() - begin)
            is_whole = self.run("check", store).returncode == 0
            self.told(f"Ctrl-C in {name}", f"ends within {SECONDS:.0f} s with 130, the store whole",
                      f"{worst:.2f} s, exit codes {sorted(codes)}, "
                      f"{'whole' if is_whole else 'damaged'}",
                      worst <= SECONDS and codes <= {0, 130, -2} and is_whole)


def _text_of(ns: int) -> str:
    """A time as queries name it."""
    seconds, rest = divmod(ns, 10**9)
    return time.strftime("%Y-%m-%dT%H:%M:%S", time.gmtime(seconds)) + f".{rest:09d}Z"


def _port_of(server: subprocess.Popen[str]) -> int:
    """The port that a server tells, whose other output is read and forgotten."""
    assert server.stdout is not None
    for line in server.stdout:
        if found := re.search(r"127\.0\.0\.1:(\d+)", line):
            threading.Thread(target=server.stdout.read, daemon=True).start()
            return int(found[1])
    raise RuntimeError("the server ended without telling its port")


def _resident_mb(process: int) -> int:
    """What a process has in RAM, in MB."""
    text = Path(f"/proc/{process}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+)", text)[1]) // 1024


def _frame(kind: int, flags: int, stream: int, payload: bytes) -> bytes:
    """A frame of HTTP/2."""
    return (len(payload).to_bytes(3, "big") + bytes([kind, flags]) + stream.to_bytes(4, "big")
            + payload)


def _flood(port: int, streams: int) -> None:
    """Opens so many HTTP/2 streams and resets each at once, until the server hangs up."""
    # POST, http, path, authority, content type, te.
    call = (b"\x83\x86\x44\x06/a/b/c\x41\x01a\x5f\x10application/grpc\x40\x02te\x08trailers")
    _say(port, (b"".join(
        _frame(1, 4, 2 * i + 1, call) + _frame(3, 0, 2 * i + 1, b"\0\0\0\x08")
        for i in range(first, first + 500)) for first in range(0, streams, 500)))


def _headers(port: int, size: int) -> None:
    """Sends so many bytes of headers of one request, until the server hangs up."""
    fields = (b"\x00\x08abcdefgh\x64" + b"v" * 100) * 140
    frames = [_frame(9, 0, 1, fields)] * 16
    _say(port, (b"".join([_frame(1, 0, 1, fields), *frames] if first == 0 else frames)
                for first in range(0, size, 16 * len(fields))))


def _say(port: int, messages: Iterable[bytes]) -> None:
    """Says all of it to a server of HTTP/2, until it hangs up."""
    with socket.create_connection(("127.0.0.1", port)) as connection:
        def drain() -> None:
            try:
                while connection.recv(1 << 16):
                    pass
            except OSError:
                pass

        reader = threading.Thread(target=drain, daemon=True)
        reader.start()
        try:
            connection.sendall(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + _frame(4, 0, 0, b""))
            for message in messages:
                connection.sendall(message)
            reader.join(timeout=30)
        except OSError:
            pass


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    names = [name for name in vars(Attacks) if name not in ("told", "run", "store", "__init__")
             and not name.startswith("_")]
    parser.add_argument("--engram", type=Path, default=Path("build/release/bin/engram"))
    parser.add_argument("--only", nargs="+", choices=names, default=names, help="these attacks")
    parser.add_argument("--snapshots", type=int, default=20_000,
                        help="images of the store that is interrupted (20,000)")
    parser.add_argument("--json", type=Path, help="also write all results to this file")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="hostile-") as folder:
        attacks = Attacks(arguments.engram.absolute(), Path(folder), arguments.snapshots)
        for name in arguments.only:
            attack: Callable[[], None] = getattr(attacks, name)
            attack()
    broken = [result for result in attacks.results if not result["kept"]]
    print(f"{len(attacks.results)} promises, {len(broken)} broken")
    if arguments.json:
        arguments.json.write_text(json.dumps(attacks.results, indent=2) + "\n")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
