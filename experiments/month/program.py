# SPDX-License-Identifier: Apache-2.0
"""Runs programs: what they write, what they cost, and how they are stopped."""
from __future__ import annotations

import contextlib
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

_running: set[int] = set()
_is_stopping = threading.Event()
_lock = threading.Lock()
MEMORY_SECONDS = 0.02  # From one look at the memory of a program to the next.


class Failed(Exception):
    """A program failed, or ended otherwise than a month needs it."""


@dataclass(frozen=True)
class Ended:
    """How a program ended."""

    code: int  #: Negative: the signal that ended it.
    out: str
    err: str
    processor_seconds: float
    megabytes: float  #: Max resident, as _PeakMemory saw it.


class _PeakMemory(threading.Thread):
    """Looks at the max resident memory of a program while it runs.

    wait4() does not tell it: its figure begins with the memory of the process that starts the
    program, and this one has whole days of images. What the kernel knows of the program alone is
    gone when it ends, so it is read all the time; what the program takes in its last hundredths of
    a second is not seen.
    """

    def __init__(self, pid: int) -> None:
        super().__init__(daemon=True)
        self._file = pathlib.Path(f"/proc/{pid}/status")
        self._is_over = threading.Event()
        self.megabytes = 0.0

    def run(self) -> None:
        self._look()
        while not self._is_over.wait(MEMORY_SECONDS):
            self._look()

    def end(self) -> float:
        self._is_over.set()
        self.join()
        return self.megabytes

    def _look(self) -> None:
        with contextlib.suppress(OSError):  # The program has just ended.
            for line in self._file.read_text().splitlines():
                if line.startswith("VmHWM:"):
                    self.megabytes = int(line.split()[1]) * 1024 / 1e6


def run(words: list[Any], *, environment: Mapping[str, str] | None = None,
        watch: Callable[[str, int], None] | None = None) -> Ended:
    """Runs a program to its end. `watch` gets each line of its stderr, and its process ID.

    Threading: any thread; several at once.
    """
    with tempfile.TemporaryFile() as out:
        with _lock:
            if _is_stopping.is_set():
                raise Failed(f"'{words[0]}' was not started: the month is being stopped")
            process = subprocess.Popen([str(word) for word in words], stdin=subprocess.DEVNULL,
                                       stdout=out, stderr=subprocess.PIPE, text=True,
                                       env={**os.environ, **(environment or {})})
            _running.add(process.pid)
        memory = _PeakMemory(process.pid)
        memory.start()
        lines = []
        assert process.stderr is not None
        for line in process.stderr:
            lines.append(line)
            if watch is not None:
                watch(line, process.pid)
        process.stderr.close()
        os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
        megabytes = memory.end()
        # Before it is waited for: until then its ID belongs to nobody else.
        with _lock:
            _running.discard(process.pid)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        return Ended(process.returncode, out.read().decode(), "".join(lines),
                     usage.ru_utime + usage.ru_stime, megabytes)


def needs(ended: Ended, what: str, *codes: int) -> Ended:
    """Raises Failed where a program ended with another exit code (0 unless some are named)."""
    if ended.code not in (codes or (0,)):
        raise Failed(f"{what} ended with {ended.code}: {ended.err[-800:]}")
    return ended


def python(module: str, *arguments: Any) -> str:
    """What a module of this package prints, run in a process of its own."""
    words = [sys.executable, "-m", f"experiments.month.{module}", *arguments]
    return needs(run(words), f"experiments.month.{module}").out


def stop_all() -> None:
    """Stops what runs, and lets nothing begin until start_again(): the month ends."""
    with _lock:
        _is_stopping.set()
        for pid in _running:
            os.kill(pid, signal.SIGTERM)


def start_again() -> None:
    """Programs may be run again, after all that were stopped have ended."""
    _is_stopping.clear()


def kill_soon(pid: int, seconds: float) -> None:
    """Kills a process that was started here in a while, if it still runs then."""
    def kill() -> None:
        with _lock:
            if pid in _running:
                os.kill(pid, signal.SIGKILL)

    timer = threading.Timer(seconds, kill)
    timer.daemon = True
    timer.start()


def build_faulty_files(source: pathlib.Path, library: pathlib.Path) -> None:
    """Compiles the library that makes a disk full for one process."""
    needs(run(["cc", "-shared", "-fPIC", "-O1", f"-I{source.parents[2]}", source, "-o", library,
               "-ldl", "-lpthread"]), "cc")
