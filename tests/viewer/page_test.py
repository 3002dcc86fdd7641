#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the tests of the viewer's page: those of its parts, what a person does in a browser, and the
page that is in the program.

page_test.py WEB parts|browser|gateway ENGRAM: WEB is where the build made the page. Exit code 77 says
that the build has no page, because npm could not fetch what it is made of, or that there is no browser.
"""

from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from viewing import Viewed, make_kitchen

NOT_RUN = 77
TESTS = pathlib.Path(__file__).resolve().parent / "page"


def missing(web: pathlib.Path, part: str) -> str | None:
    """Why these tests cannot run."""
    if not (web / "node_modules" / ".engram-lock").exists() or not (web / "dist" / "assets").is_dir():
        return f"'{web}' has no page that npm built"
    if part != "parts" and not shutil.which(os.environ.get("CHROMIUM", "chromium")):
        return "there is no browser: apt-get install chromium"
    return None


def run(web: pathlib.Path, *words: str, **environment: str) -> int:
    return subprocess.run(["node", str(web / "node_modules" / "vitest" / "vitest.mjs"), "run", *words],
                          cwd=web, check=False, env={**os.environ, "CI": "1",
                                                     "PAGE_TESTS": str(TESTS), **environment}).returncode


def main() -> int:
    web, part, engram = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3]
    reason = missing(web, part)
    if reason:
        print(f"not run: {reason}")
        return NOT_RUN
    if part == "parts":
        return run(web)
    page = ("--config", "vitest.page.config.ts")
    if part == "browser":
        return run(web, *page, "--exclude", "**/gateway.test.ts")
    with tempfile.TemporaryDirectory() as folder:
        store = make_kitchen(engram, pathlib.Path(folder), 8, learned=True)
        subprocess.run([engram, "map", "make", str(store)], check=True, stdout=subprocess.DEVNULL)
        with Viewed(engram, str(store)) as viewed:
            return run(web, *page, "gateway.test.ts", VIEW_URL=viewed.url)


if __name__ == "__main__":
    sys.exit(main())
