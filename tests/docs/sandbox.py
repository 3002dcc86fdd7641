# SPDX-License-Identifier: Apache-2.0
"""A folder of its own in which the commands of one document run, with `engram` on the PATH."""

from __future__ import annotations

import os
import pathlib
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass, field

BLOCK_SECONDS = 120
_READY_SECONDS = 30
_END_SECONDS = 30


class BlockError(Exception):
    """A block did not do what its document says."""


@dataclass
class _Background:
    process: subprocess.Popen[bytes]
    output: pathlib.Path
    place: str


@dataclass
class Sandbox:
    """Owns: the processes that run in the background, until close()."""

    folder: pathlib.Path
    engram: pathlib.Path
    python_path: str
    running: list[_Background] = field(default_factory=list)

    def __post_init__(self) -> None:
        for name in ("home", "run", "bin"):
            (self.folder / ".box" / name).mkdir(parents=True)
        (self.folder / ".box" / "run").chmod(0o700)
        (self.folder / ".box" / "bin" / "engram").symlink_to(self.engram)

    @property
    def environment(self) -> dict[str, str]:
        box = self.folder / ".box"
        kept = {key: value for key, value in os.environ.items()
                if not key.startswith(("ENGRAM_", "XDG_", "PYTHON"))}
        return kept | {
            "PATH": f"{box / 'bin'}:/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin",
            "HOME": str(box / "home"),
            "XDG_RUNTIME_DIR": str(box / "run"),
            "XDG_CONFIG_HOME": str(box / "home/config"),
            "XDG_CACHE_HOME": str(box / "home/cache"),
            "XDG_DATA_HOME": str(box / "home/data"),
            "PYTHONPATH": self.python_path,
            "PYTHONDONTWRITEBYTECODE": "1",
            "MPLBACKEND": "Agg",
            "OMP_WAIT_POLICY": "passive",
            "LC_ALL": "C.UTF-8",
        }

    def run(self, commands: str, exit_code: int = 0) -> str:
        """What they print; they end at the first that fails. Raises BlockError."""
        process = subprocess.Popen(
            ["bash", "-euo", "pipefail", "-c", commands], cwd=self.folder, env=self.environment,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            start_new_session=True)
        try:
            output = process.communicate(timeout=BLOCK_SECONDS)[0].decode(errors="replace")
        except subprocess.TimeoutExpired as expired:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()
            raise BlockError(f"took longer than {BLOCK_SECONDS} s") from expired
        if process.returncode != exit_code:
            raise BlockError(f"exit code {process.returncode}, needs {exit_code}\n{_tail(output)}")
        return output

    def start(self, commands: str, ready: str, place: str) -> str:
        """Runs them in the background; what they printed until they said `ready`."""
        output = self.folder / ".box" / f"background{len(self.running)}"
        with output.open("wb") as file:
            process = subprocess.Popen(
                ["bash", "-euo", "pipefail", "-c", commands], cwd=self.folder,
                env=self.environment, stdin=subprocess.DEVNULL, stdout=file, stderr=file,
                start_new_session=True)
        self.running.append(_Background(process, output, place))
        until = time.monotonic() + _READY_SECONDS
        while True:
            said = output.read_text(errors="replace")
            if ready in said:
                return said
            if process.poll() is not None:
                raise BlockError(f"ended with {process.returncode} before '{ready}'\n{_tail(said)}")
            if time.monotonic() > until:
                raise BlockError(f"did not say '{ready}' in {_READY_SECONDS} s\n{_tail(said)}")
            time.sleep(0.05)

    def copy_in(self, source: pathlib.Path, name: str) -> None:
        target = self.folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, target, dirs_exist_ok=True)
        else:
            shutil.copy2(source, target)

    def close(self) -> list[str]:
        """Ends what runs in the background, the last first; what went wrong with it."""
        return [problem for one in reversed(self.running) if (problem := _end(one))]


def _end(one: _Background) -> str:
    code = one.process.poll()
    if code not in (None, 0):
        return f"{one.place}: ended by itself with {code}\n{_tail(one.output.read_text())}"
    try:
        os.killpg(one.process.pid, signal.SIGTERM)
        one.process.wait(_END_SECONDS)
        until = time.monotonic() + _END_SECONDS
        while time.monotonic() < until:
            os.killpg(one.process.pid, 0)
            time.sleep(0.02)
    except ProcessLookupError:
        return ""
    except subprocess.TimeoutExpired:
        pass
    os.killpg(one.process.pid, signal.SIGKILL)
    return f"{one.place}: did not end in {_END_SECONDS} s after SIGTERM"


def _tail(text: str) -> str:
    return "\n".join("    | " + line for line in text.rstrip().split("\n")[-25:])
