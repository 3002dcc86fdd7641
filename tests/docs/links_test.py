# SPDX-License-Identifier: Apache-2.0
"""Links in the documentation lead somewhere, and every page is reached from README.md."""

from __future__ import annotations

import pathlib
import re
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
_LINK = re.compile(r"\]\(([^)#\s]*)(#[^)\s]*)?\)")
_MENTION = re.compile(
    r"`((?:docs|experiments|tests|cli)/[\w./-]+\.(?:md|yaml|service|timer|py|sh|xml))`")
_CODE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


def pages(source: pathlib.Path) -> list[pathlib.Path]:
    return [source / "README.md", *sorted(source.glob("docs/**/*.md"))]


def targets_of(page: pathlib.Path, source: pathlib.Path) -> list[tuple[pathlib.Path, str]]:
    """Files (and headings in them) that a page leads to."""
    text = _CODE.sub("", page.read_text())
    found = []
    for target, heading in _LINK.findall(text):
        if not target.startswith(("http:", "https:")):
            found.append(((page.parent / target).resolve() if target else page, heading))
    return found + [(source / one, "") for one in _MENTION.findall(text)]


def headings_of(page: pathlib.Path) -> set[str]:
    titles = re.findall(r"^#+ (.*)$", _CODE.sub("", page.read_text()), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def problems_of(source: pathlib.Path) -> list[str]:
    found = []
    reached = {source / "README.md"}
    waiting = [source / "README.md"]
    while waiting:
        for target, _ in targets_of(waiting.pop(), source):
            if target.suffix == ".md" and target.exists() and target not in reached:
                reached.add(target)
                waiting.append(target)
    for page in pages(source):
        if page not in reached:
            found.append(f"{page.relative_to(source)}: no way leads here from README.md")
        for target, heading in targets_of(page, source):
            if not target.exists():
                found.append(f"{page.relative_to(source)}: {target} is not there")
            elif heading and heading[1:] not in headings_of(target):
                found.append(f"{page.relative_to(source)}: {target.name} has no heading {heading}")
    return found


class Links(unittest.TestCase):
    def test_lead_somewhere(self) -> None:
        self.assertEqual(problems_of(SOURCE), [])

    def test_that_lead_nowhere_are_found(self) -> None:
        with tempfile.TemporaryDirectory() as scratch:
            source = pathlib.Path(scratch).resolve()
            (source / "docs").mkdir()
            (source / "README.md").write_text("[a](docs/a.md) [b](docs/b.md#c-d) `docs/e.md`\n")
            (source / "docs/b.md").write_text("## C e\n\n[up](../README.md)\n")
            (source / "docs/lost.md").write_text("[this](#none)\n")
            found = "\n".join(problems_of(source))
        for part in ("docs/a.md is not there", "docs/e.md is not there", "no heading #c-d",
                     "docs/lost.md: no way leads here", "no heading #none"):
            self.assertIn(part, found)
        self.assertEqual(found.count("\n"), 4)


if __name__ == "__main__":
    unittest.main()
