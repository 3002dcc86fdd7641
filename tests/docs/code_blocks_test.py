#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Every code block of the documentation runs, or says why it does not.

code_blocks_test.py --engram FILE --build DIR [--python DIR] [--keep DIR] [DOCUMENT...]
"""

from __future__ import annotations

import argparse
import collections
import concurrent.futures
import pathlib
import shutil
import sys
import tempfile
import time

from document_run import DocumentReport, Tools, run_document
from fixtures import Fixtures

SOURCE = pathlib.Path(__file__).resolve().parents[2]
#: Made of what is tested elsewhere: help texts and docstrings, which have their own tests.
GENERATED = ("docs/reference/",)


def documents_of(source: pathlib.Path) -> list[str]:
    found = ["README.md", *(str(one.relative_to(source)) for one in source.glob("docs/**/*.md"))]
    return [name for name in sorted(found) if not name.startswith(GENERATED)]


def run_all(documents: list[str], tools: Tools, scratch: pathlib.Path) -> list[DocumentReport]:
    fixtures = Fixtures(scratch / "fixtures", tools.engram, tools.source)

    def one(name: str) -> DocumentReport:
        begin = time.monotonic()
        folder = scratch / name.replace("/", "-").removesuffix(".md")
        report = run_document(tools.source / name, name, folder, tools, fixtures)
        counts = ", ".join(f"{count} {what}" for what, count in sorted(report.counts.items()))
        print(f"{time.monotonic() - begin:6.1f} s  {name}: {counts or 'none run'}", flush=True)
        return report

    with concurrent.futures.ThreadPoolExecutor(max_workers=2) as pool:
        return list(pool.map(one, documents))


def summary(reports: list[DocumentReport]) -> str:
    counts = sum((report.counts for report in reports), collections.Counter[str]())
    left_out = [line for report in reports for line in report.left_out]
    failures = [line for report in reports for line in report.failures]
    lines = [f"{sum(counts.values()) + len(left_out)} blocks in {len(reports)} documents: "
             + ", ".join(f"{count} {what}" for what, count in sorted(counts.items()))
             + f", {len(left_out)} not run, {len(failures)} failed"]
    lines += [f"  not run: {line}" for line in left_out]
    lines += [f"FAILED {line}" for line in failures]
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--engram", type=pathlib.Path, required=True)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--python", default="", help="what `import engram` needs on PYTHONPATH")
    parser.add_argument("--keep", type=pathlib.Path, help="leaves what blocks wrote below it")
    parser.add_argument("documents", nargs="*")
    given = parser.parse_args()
    tools = Tools(given.engram.resolve(), SOURCE, given.python,
                  given.build / "compile_commands.json")
    scratch = pathlib.Path(tempfile.mkdtemp(prefix="engram_docs_", dir=given.keep))
    try:
        reports = run_all(given.documents or documents_of(SOURCE), tools, scratch.resolve())
    finally:
        if not given.keep:
            shutil.rmtree(scratch, ignore_errors=True)
    print(summary(reports))
    return 1 if any(report.failures for report in reports) else 0


if __name__ == "__main__":
    sys.exit(main())
