# SPDX-License-Identifier: Apache-2.0
"""The report: one file, numbers as people read them, nothing hidden that was not run."""

import html.parser
import pathlib

from experiments.loocv import show as loocv
from experiments.paper import charts
from experiments.paper.report import Figure, Section, Table, number, significant, write_page
from experiments.transfer import show as transfer


class Links(html.parser.HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag, attributes):
        self.found += [value for name, value in attributes if name in ("src", "href")]


def test_numbers_are_written_for_people():
    assert number(3.14159) == "3.14"
    assert number(-1.5, 1) == "−1.5"
    assert number(None) == "not run"
    assert number(float("nan")) == "–"
    assert significant(0.0012345) == "0.00123"
    assert significant(1234567.0) == "1,234,567"


def test_a_page_needs_no_other_file(tmp_path: pathlib.Path):
    figure, axes = charts.panels(1)
    axes[0, 0].plot([1, 2])
    file = charts.save(figure, tmp_path / "plot.png")
    section = Section("one", "One", [Table("rows", ["", "a"], [["x", "1"]], paper=["x"]),
                                     Figure("a plot", file, "a line")])
    section.text("text")
    page = tmp_path / "page.html"
    write_page(page, "Title", "<p>lead</p>", [section])
    file.unlink()
    links = Links()
    links.feed(page.read_text(encoding="utf-8"))
    assert links.found == ["#one"] + [one for one in links.found if one.startswith("data:image/")]
    assert len(links.found) == 2


def test_what_was_not_run_is_said(tmp_path: pathlib.Path):
    class Nothing:
        config = {"samples": 1, "entries": 1}
        folder = tmp_path

    rows = [{"object": name, "batch": 1} for name in ("simple", "moderate", "complex")]
    section = transfer.show(Nothing(), {"steps": [row | {"steps": {}} for row in rows],
                                        "ages": rows})
    page = tmp_path / "page.html"
    write_page(page, "Title", "", [section])
    assert page.read_text(encoding="utf-8").count("not run") == 3 * (5 + 4 + 3)


def fold(images: int, db: float) -> dict:
    ahead = [{"images": images, "mean_psnr_db": db, "mean_ssim": 0.5}] * 2
    return {"baselines": dict.fromkeys(("copy-last", "linear", "flow"), ahead), "variants": {}}


def test_means_over_folds_count_images():
    assert loocv.over_folds([fold(1, 20), fold(3, 30)], "linear", "mean_psnr_db") == [27.5, 27.5]


def test_agreement_is_the_largest_difference():
    case = {"images": [fold(2, 20)],
            "agreement": {"linear": {"images": 2, "psnr_db": 20.25, "ssim": 0.5}}}
    assert loocv.worst_disagreement([case]) == 0.25
