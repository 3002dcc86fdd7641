#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Builds the page of the viewer with npm, in a copy of its sources.

build_page.py --source DIR --work DIR --fallback DIR [--needed]

The built page is in WORK/dist. If npm is missing, or a package cannot be had, the fallback takes
its place and a warning says so; with --needed that is an error. A page that does not compile is one
always: the fallback would hide it.
"""

from __future__ import annotations

import argparse
import pathlib
import shutil
import subprocess
import sys

#: What npm makes beside the sources; it is no source.
MADE = ("node_modules", "dist", "coverage", "test-results", "playwright-report")


class PageError(Exception):
    """Why there is no page."""


class BrokenPage(PageError):
    """The page is wrong itself."""


def copy_sources(source: pathlib.Path, work: pathlib.Path) -> None:
    """Copies what is there, and takes away what is not there any more. Installed packages stay."""
    work.mkdir(parents=True, exist_ok=True)
    for old in work.iterdir():
        if old.name not in MADE:
            shutil.rmtree(old) if old.is_dir() else old.unlink()
    shutil.copytree(source, work, dirs_exist_ok=True, ignore=shutil.ignore_patterns(*MADE))


def run(work: pathlib.Path, *words: str, failure: type[PageError] = PageError) -> None:
    try:
        done = subprocess.run(words, cwd=work, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=600, check=False)
    except FileNotFoundError:
        raise PageError(f"'{words[0]}' is missing: apt-get install nodejs npm") from None
    except subprocess.TimeoutExpired:
        raise PageError(f"'{' '.join(words)}' took longer than 10 minutes") from None
    if done.returncode != 0:
        tail = "\n".join(done.stdout.strip().split("\n")[-20:])
        raise failure(f"'{' '.join(words)}' failed:\n{tail}")


def install(work: pathlib.Path) -> None:
    """Installs what the lock file names, unless that is there already."""
    lock = work / "package-lock.json"
    mark = work / "node_modules" / ".engram-lock"
    if mark.exists() and mark.read_bytes() == lock.read_bytes():
        return
    run(work, "npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--fetch-retries=1",
        "--fetch-timeout=60000")
    mark.write_bytes(lock.read_bytes())


def build(source: pathlib.Path, work: pathlib.Path) -> None:
    if not (source / "package.json").exists():
        raise PageError(f"'{source}' has no sources of the page")
    copy_sources(source, work)
    install(work)
    run(work, "npm", "run", "build", failure=BrokenPage)
    if not (work / "dist" / "index.html").exists():
        raise BrokenPage("'npm run build' made no dist/index.html")


def main() -> int:
    parser = argparse.ArgumentParser()
    for name in ("source", "work", "fallback"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    parser.add_argument("--needed", action="store_true")
    given = parser.parse_args()
    try:
        build(given.source, given.work)
    except PageError as error:
        if given.needed or isinstance(error, BrokenPage):
            print(f"build_page.py: {error}", file=sys.stderr)
            return 1
        print(f"warning: the page of 'engram view' is left out: {error}\nIt then shows how to get "
              f"it. To build it again: rm -r {given.work}", file=sys.stderr)
        shutil.rmtree(given.work / "dist", ignore_errors=True)
        shutil.copytree(given.fallback, given.work / "dist")
    return 0


if __name__ == "__main__":
    sys.exit(main())
