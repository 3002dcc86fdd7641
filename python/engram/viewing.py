# SPDX-License-Identifier: Apache-2.0
"""A memory in the browser, or in a frame of a notebook: `memory.view()`."""

from __future__ import annotations

import html
import json
import os
import pathlib
import shutil
import signal
import subprocess
import weakref
from collections.abc import Sequence
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any

from engram.closing import Closing
from engram.errors import FailedPreconditionError, InvalidArgumentError, NotFoundError

if TYPE_CHECKING:
    from engram.memory import Memory

_LANES = 24  #: Of the picture; a memory may have a hundred thousand entities.
_WIDTH, _NAMES, _LANE = 900, 330, 18  # Pixels.


class View(Closing):
    """A running `engram view`, until it is closed or this program ends.

    A notebook shows it in a frame. Where the page is not reached, such as in a notebook that is
    only read, a picture of the timeline stands there. `url` has a token: who has it may look while
    this runs, and so may who gets the notebook from this machine meanwhile.

    Threading: one thread.
    """

    def __init__(self, words: Sequence[str], notebook: str, height: int, picture: str) -> None:
        """`words`: the command. Made by Memory.view."""
        self.height = height
        self.picture = picture  #: The timeline as SVG, as it was then.
        self._process = subprocess.Popen(
            words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            text=True, start_new_session=True,
        )
        self._end = weakref.finalize(self, _end, self._process)
        assert self._process.stdout and self._process.stderr
        line = self._process.stdout.readline()
        if not line:
            reason = self._process.stderr.read().strip() or "it told nothing"
            self._end()
            raise FailedPreconditionError(f"engram view: {reason}")
        self.url: str = json.loads(line)["url"]
        # Browsers send cookies in frames of the same site alone, which has the name of the notebook.
        if "//localhost" in notebook:
            self.url = self.url.replace("//127.0.0.1:", "//localhost:", 1)

    def close(self) -> None:
        """Ends it. The picture stays."""
        self._end()

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        page = (
            f'<object data="{html.escape(self.url)}" type="text/html" width="100%"'
            f' height="{self.height}" aria-label="Viewer of a memory">{self.picture}</object>'
        )
        return {"text/html": page, "image/svg+xml": self.picture, "text/plain": repr(self)}

    def __repr__(self) -> str:
        return f"<View {self.url if self._end.alive else 'is closed'}>"


def view(
    memory: Memory, notebook: str, height: int, program: str | None, options: Sequence[str]
) -> View:
    """See Memory.view."""
    if height < 100:
        raise InvalidArgumentError(f"height {height}: needs at least 100 pixels")
    words = [_program(program), "view", "--json", "--embed", notebook, *options]
    if memory.path:
        words.append(memory.path)
    elif memory.endpoint:
        words += ["--server", memory.endpoint]
    return View(words, notebook, height, picture_of(memory))


def picture_of(memory: Memory) -> str:
    """The entities of a memory on one time axis, as SVG."""
    entities = list(memory)[:_LANES]
    spans = [(entity.first, entity.last) for entity in entities]
    first = min((span[0] for span in spans), default=0)
    last = max(max((span[1] for span in spans), default=1), first + 1)
    room = _WIDTH - _NAMES - 70
    height = _LANE * (len(entities) + 2)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" role="img"'
        ' font-family="sans-serif" font-size="11" fill="#333" aria-label="Timeline of a memory">'
    ]
    for i, (entity, (begin, end)) in enumerate(zip(entities, spans)):
        y = _LANE * (i + 1)
        x = _NAMES + room * (begin - first) / (last - first)
        width = max(2.0, room * (end - begin) / (last - first))
        name = "".join(c if c.isprintable() else "?" for c in entity.name)
        name = name if len(name) <= 50 else "..." + name[-47:]
        lines.append(
            f'<text x="{_NAMES - 8}" y="{y + 10}" text-anchor="end">{html.escape(name)}</text>'
            f'<rect x="{x:.1f}" y="{y + 2}" width="{width:.1f}" height="10" fill="#0072b2"/>'
            f'<text x="{_WIDTH}" y="{y + 10}" text-anchor="end">{len(entity)}</text>'
        )
    more = len(memory) - len(entities)
    when = f"{_clock(first)} to {_clock(last)} UTC" if entities else "an empty memory"
    lines.append(
        f'<text x="{_NAMES}" y="12">{when}</text>'
        + (f'<text x="0" y="{height - 4}">and {more} more entities</text>' if more else "")
        + "</svg>"
    )
    return "".join(lines)


def _clock(time: int) -> str:
    return datetime.fromtimestamp(time / 1e9, timezone.utc).strftime("%Y-%m-%d %H:%M:%S")


def _program(given: str | None) -> str:
    """The program: that of a build is two folders above the package."""
    beside = pathlib.Path(__file__).resolve().parents[2] / "bin" / "engram"
    found = given or (str(beside) if os.access(beside, os.X_OK) else shutil.which("engram"))
    if not found:
        raise NotFoundError("the program 'engram' is not on the PATH: name it as program=...")
    if not shutil.which(found):
        raise NotFoundError(f"program '{found}': is no program")
    return found


def _end(process: subprocess.Popen[str]) -> None:
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    for stream in (process.stdout, process.stderr):
        if stream:
            stream.close()
