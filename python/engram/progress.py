# SPDX-License-Identifier: Apache-2.0
"""How far a long piece of work is."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Union


@dataclass(frozen=True)
class Progress:
    """Told about 20 times a second at most, from the thread that waits for the job."""

    what: str  #: "train Vision/RGB/head/cam", ...
    done: int
    total: int  #: Same unit as `done`; 0 where nobody knows.
    detail: str  #: "autoencoder, epoch 3, 31.20 dB, 210 B"; may be empty.
    seconds_left: float | None  #: None where nobody knows.


ProgressLike = Union[bool, Callable[[Progress], None], None]


class Bar:
    """A bar of tqdm for each piece of work; without tqdm a line on stderr that is written over.

        engram.consolidate("robot.engram", progress=engram.Bar())

    `progress=True` is the same.
    """

    def __init__(self) -> None:
        self._bar: Any = None
        self._what = ""
        self._tqdm: Any = None
        try:
            self._tqdm = importlib.import_module("tqdm.auto").tqdm
        except ImportError:
            pass

    def __call__(self, progress: Progress) -> None:
        if self._tqdm is None:
            self._write(progress)
            return
        if progress.what != self._what:
            self.close()
            self._what = progress.what
            self._bar = self._tqdm(total=progress.total or None, desc=progress.what, leave=True)
        self._bar.total = progress.total or None
        self._bar.set_postfix_str(progress.detail, refresh=False)
        self._bar.update(progress.done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
        elif self._what:
            print(file=sys.stderr)
        self._bar, self._what = None, ""

    def _write(self, progress: Progress) -> None:
        if self._what and progress.what != self._what:
            print(file=sys.stderr)
        self._what = progress.what
        share = f"{100 * progress.done / progress.total:3.0f} %" if progress.total else ""
        text = f"{progress.what}  {share}  {progress.detail}"
        print(f"\r{text:<78.78}", end="", file=sys.stderr, flush=True)


def sink_of(progress: ProgressLike) -> tuple[Callable[..., None] | None, Callable[[], None]]:
    """What the C++ side calls, and what is to be called at the end."""
    if progress is None or progress is False:
        return None, lambda: None
    bar: Any = Bar() if progress is True else progress

    def tell(what: str, done: int, total: int, detail: str, seconds_left: float | None) -> None:
        bar(Progress(what, done, total, detail, seconds_left))

    return tell, bar.close if isinstance(bar, Bar) else lambda: None
