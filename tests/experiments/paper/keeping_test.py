# SPDX-License-Identifier: Apache-2.0
"""What is kept of a run goes into the project: no images of recordings are in it."""

import argparse
import json
import pathlib

import pytest

from experiments.paper import measuring, single
from experiments.paper.report import Figure, Section


@pytest.fixture
def root(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    """A project of one experiment, `transfer`."""
    folder = tmp_path / "experiments" / "transfer"
    folder.mkdir(parents=True)
    (folder / "config.json").write_text('{"short": {}}')
    monkeypatch.setattr(measuring, "ROOT", tmp_path)
    monkeypatch.setattr(single, "ROOT", tmp_path)
    monkeypatch.setattr(measuring.Measuring, "version", lambda self: "engram 1")
    return tmp_path


def run(root: pathlib.Path, networks_from: pathlib.Path | None = None,
        ) -> tuple[measuring.Measuring, Section]:
    options = argparse.Namespace(
        engram=root / "engram", programs=root, recordings="", profile="short", work=root / "work",
        again=False, minutes=1, keep=True, networks_from=networks_from)

    def show(one: measuring.Measuring, found: object) -> Section:
        section = Section("transfer", "Transfer")
        for name in ("curves", "frames"):
            file = one.folder / f"transfer-{name}.png"
            file.write_bytes(name.encode())
            section.blocks.append(Figure(name, file, name, is_recorded=name == "frames"))
        return section

    return single.run_one("transfer", options, lambda one: one.measured("a", {}, lambda: 7), show)


def test_images_of_recordings_are_not_kept(root):
    stale = root / "experiments" / "transfer" / "results" / "stale.png"
    stale.parent.mkdir()
    stale.touch()
    run(root)
    assert sorted(file.name for file in stale.parent.iterdir()) == ["curves.png", "result.json"]
    assert (stale.parent / "curves.png").read_bytes() == b"curves"


def test_networks_of_an_earlier_run_are_named_and_their_pictures_stay(root):
    results = root / "experiments" / "transfer" / "results"
    results.mkdir()
    drawn = results / "drawn.png"
    drawn.touch()
    earlier = root / "earlier.json"
    earlier.write_text('{"found": [{"dataset": "g1", "latents": 5}]}')
    one, _ = run(root, earlier)
    assert drawn.exists()
    assert one.earlier({"dataset": "g1"}) == {"dataset": "g1", "latents": 5}
    with pytest.raises(SystemExit, match="kitchen"):
        one.earlier({"dataset": "kitchen"})
    kept = json.loads((results / "result.json").read_text())
    assert kept["networks_from"] == measuring.file_fingerprint(earlier)
    # A result that was itself made so names the first one.
    again = root / "again.json"
    again.write_text(json.dumps({**kept, "found": []}))
    run(root, again)
    assert json.loads((results / "result.json").read_text())["networks_from"] == (
        kept["networks_from"])


def test_a_report_names_the_sources_of_every_result(root, monkeypatch):
    monkeypatch.setattr(measuring, "sources", lambda: "abc1234")
    run(root)
    monkeypatch.setattr(measuring, "sources", lambda: "fff0000")
    again, _ = run(root)
    again.measured("b", {}, lambda: 8)
    assert "sources at abc1234, fff0000;" in single.facts([again])
