# SPDX-License-Identifier: Apache-2.0
"""Sections of text, tables and figures, written as one HTML file that needs no other."""

from __future__ import annotations

import base64
import html
import pathlib
from collections.abc import Sequence
from dataclasses import dataclass, field

NOT_RUN = "not run"
# Columns of text, by their heads.
WORDS = ("recipe", "unit")


@dataclass(frozen=True)
class Text:
    """A paragraph of HTML."""

    html: str


@dataclass(frozen=True)
class Table:
    """`rows` of texts; the first column names the row. Rows of one text span the table. `paper`:
    rows and columns that are the paper's, by their text in the first column or the head."""

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    note: str = ""
    paper: Sequence[str] = ()


@dataclass(frozen=True)
class Figure:
    caption: str
    file: pathlib.Path
    alt: str
    is_recorded: bool = False  # It shows images of recordings, which are not ours to give away.


@dataclass
class Section:
    name: str
    title: str
    blocks: list[Text | Table | Figure] = field(default_factory=list)

    def text(self, paragraph: str) -> None:
        self.blocks.append(Text(paragraph))


def number(value: float | None, digits: int = 2, sign: bool = False) -> str:
    """`value` with so many decimals; "not run" where there is none, "-" where it is not finite."""
    if value is None:
        return NOT_RUN
    if value != value or value in (float("inf"), float("-inf")):
        return "–"
    return f"{value:{'+' if sign else ''}.{digits}f}".replace("-", "−")


def significant(value: float | None, digits: int = 3) -> str:
    """So many digits that count, never as a power of ten."""
    if value is None or value != value:
        return number(value)
    if value == 0:
        return "0"
    import math

    return f"{value:,.{max(0, digits - 1 - math.floor(math.log10(abs(value))))}f}"


class Page:
    """Numbers tables and figures through all sections."""

    def __init__(self) -> None:
        self.tables = 0
        self.figures = 0

    def block(self, block: Text | Table | Figure) -> str:
        if isinstance(block, Text):
            return f"<p>{block.html}</p>"
        if isinstance(block, Figure):
            self.figures += 1
            data = base64.b64encode(block.file.read_bytes()).decode()
            return (f'<figure id="figure-{self.figures}"><img alt="{html.escape(block.alt)}" '
                    f'src="data:image/png;base64,{data}"><figcaption><b>Figure {self.figures}.</b> '
                    f"{block.caption}</figcaption></figure>")
        self.tables += 1
        return self._table(block)

    def _table(self, table: Table) -> str:
        head = "".join(self._cell("th", text, table.paper, text) for text in table.head)
        rows = []
        for row in table.rows:
            if len(row) == 1:
                rows.append(f'<tr class="group"><th colspan="{len(table.head)}">{row[0]}</th></tr>')
                continue
            is_paper = row[0] in table.paper
            cells = "".join(
                self._cell("th" if i == 0 else "td", text, table.paper, column)
                for i, (text, column) in enumerate(zip(row, table.head, strict=True)))
            rows.append(f"<tr{' class=paper' if is_paper else ''}>{cells}</tr>")
        note = f'<p class="note">{table.note}</p>' if table.note else ""
        return (f'<div class="table" id="table-{self.tables}"><table><caption><b>Table '
                f"{self.tables}.</b> {table.caption}</caption><thead><tr>{head}</tr></thead>"
                f"<tbody>{''.join(rows)}</tbody></table>{note}</div>")

    @staticmethod
    def _cell(tag: str, text: str, paper: Sequence[str], column: str) -> str:
        kinds = [name for name, is_so in (("paper", column in paper), ("missing", text == NOT_RUN),
                                          ("words", column in WORDS)) if is_so]
        mark = f' class="{" ".join(kinds)}"' if kinds else ""
        return f"<{tag}{mark}>{text}</{tag}>"


def write_page(file: pathlib.Path, title: str, lead: str, sections: Sequence[Section]) -> None:
    page = Page()
    style = (pathlib.Path(__file__).parent / "report.css").read_text()
    links = "".join(f'<li><a href="#{one.name}">{one.title}</a></li>' for one in sections)
    body = "".join(
        f'<section id="{one.name}"><h2>{number}. {one.title}</h2>'
        + "".join(page.block(block) for block in one.blocks) + "</section>"
        for number, one in enumerate(sections, start=1))
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{title}</title><style>{style}</style></head><body><main><header><h1>{title}</h1>"
        f"{lead}<nav><ol>{links}</ol></nav></header>{body}</main></body></html>\n",
        encoding="utf-8")
