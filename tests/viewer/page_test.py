#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the tests of the viewer's page: those of its parts, and what a person does in a browser.

page_test.py WEB parts|browser: WEB is where the build made the page. Exit code 77 says that the
build has no page, because npm could not fetch what it is made of, or that there is no browser.
"""

from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
import sys

NOT_RUN = 77
TESTS = pathlib.Path(__file__).resolve().parent / "page"


def missing(web: pathlib.Path, part: str) -> str | None:
    """Why these tests cannot run."""
    if not (web / "node_modules" / ".engram-lock").exists() or not (web / "dist" / "assets").is_dir():
        return f"'{web}' has no page that npm built"
    if part == "browser" and not shutil.which(os.environ.get("CHROMIUM", "chromium")):
        return "there is no browser: apt-get install chromium"
    return None


def main() -> int:
    web, part = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    reason = missing(web, part)
    if reason:
        print(f"not run: {reason}")
        return NOT_RUN
    words = ["node", str(web / "node_modules" / "vitest" / "vitest.mjs"), "run"]
    if part == "browser":
        words += ["--config", "vitest.page.config.ts"]
    return subprocess.run(words, cwd=web, check=False,
                          env={**os.environ, "CI": "1", "PAGE_TESTS": str(TESTS)}).returncode


if __name__ == "__main__":
    sys.exit(main())
