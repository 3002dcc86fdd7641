# SPDX-License-Identifier: Apache-2.0
"""One Python interpreter that executes the Python blocks of a document, one after the other.

Started as a program it is that interpreter: a line of JSON {file, line, code} on stdin, a line of
JSON {output, error} on the descriptor that its argument names.
"""

from __future__ import annotations

import contextlib
import doctest
import io
import json
import os
import pathlib
import select
import subprocess
import sys
import traceback
from typing import Any

from sandbox import BLOCK_SECONDS, BlockError


class PythonSession:
    """Owns: the interpreter, until close()."""

    def __init__(self, folder: pathlib.Path, environment: dict[str, str]) -> None:
        reader, writer = os.pipe()
        here = str(pathlib.Path(__file__).parent)
        with (folder / ".box" / "python_stderr").open("wb") as messages:
            self._process = subprocess.Popen(
                ["/usr/bin/python3", __file__, str(writer)], cwd=folder, pass_fds=[writer],
                env=environment | {"PYTHONPATH": f"{environment['PYTHONPATH']}:{here}"},
                stdin=subprocess.PIPE, stderr=messages, text=True)
        os.close(writer)
        self._answers = os.fdopen(reader)

    def run(self, file: str, line: int, code: str) -> str:
        """What the code prints. Raises BlockError with its traceback."""
        assert self._process.stdin
        self._process.stdin.write(json.dumps({"file": file, "line": line, "code": code}) + "\n")
        self._process.stdin.flush()
        if not select.select([self._answers], [], [], BLOCK_SECONDS)[0]:
            self._process.kill()
            raise BlockError(f"took longer than {BLOCK_SECONDS} s")
        text = self._answers.readline()
        if not text:
            raise BlockError(f"the interpreter ended with {self._process.wait()}")
        answer = json.loads(text)
        if answer["error"]:
            raise BlockError(answer["error"])
        return str(answer["output"])

    def close(self) -> None:
        assert self._process.stdin
        with contextlib.suppress(BrokenPipeError):
            self._process.stdin.close()
        self._process.wait()
        self._answers.close()


def execute(request: dict[str, Any], names: dict[str, Any]) -> dict[str, str]:
    """Executes one block. `names` are the variables, which the next block finds again."""
    output = io.StringIO()
    error = ""
    with contextlib.redirect_stdout(output):
        try:
            if request["code"].lstrip().startswith(">>>"):
                error = _doctest(request, names, output)
            else:
                code = "\n" * (request["line"] - 1) + request["code"]
                exec(compile(code, request["file"], "exec"), names)
        except BaseException:  # A block may raise what it likes, SystemExit too.
            error = traceback.format_exc()
    return {"output": output.getvalue(), "error": error}


def _doctest(request: dict[str, Any], names: dict[str, Any], output: io.StringIO) -> str:
    test = doctest.DocTestParser().get_doctest(
        request["code"], names, request["file"], request["file"], request["line"] - 1)
    test.globs = names
    runner = doctest.DocTestRunner(
        optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE, verbose=False)
    failed = runner.run(test, out=output.write, clear_globs=False).failed
    return output.getvalue() if failed else ""


def main() -> None:
    sys.path = [one for one in sys.path if one != str(pathlib.Path(__file__).parent)] + [""]
    names: dict[str, Any] = {"__name__": "__main__"}
    with os.fdopen(int(sys.argv[1]), "w") as answers:
        for line in sys.stdin:
            answers.write(json.dumps(execute(json.loads(line), names)) + "\n")
            answers.flush()


if __name__ == "__main__":
    main()
