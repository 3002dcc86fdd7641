# SPDX-License-Identifier: Apache-2.0
"""Stores of every version of the format that was released open, whole, and go on."""

from __future__ import annotations

import importlib.util
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import engram
from engram import idf

FOLDER = Path(__file__).parents[2] / "golden" / "store"
STORES = sorted(FOLDER.glob("format_*"))


def made(script: str) -> Any:
    spec = importlib.util.spec_from_file_location(script, FOLDER / f"{script}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


GOLDEN = made("make_store")
FADED = made("make_faded")
MANY = made("make_many")
# As it was stored.
FIRST_POSITION = ["0x1.0000000000000p+0", "0x1.14a280fb5068bp-1", "-0x1.aa22657537205p-2"]
ALL = range(GOLDEN.COUNT + GOLDEN.UNSEALED)


@pytest.fixture(params=STORES, ids=lambda path: path.name)
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    shutil.copytree(request.param, tmp_path / "robot.engram")
    return tmp_path / "robot.engram"


def test_there_is_one_of_each_version() -> None:
    assert [path.name for path in STORES] == ["format_1"]


def test_it_is_whole(store: Path) -> None:
    report = engram.check(store, deep=True)
    assert report["clean"], report["findings"]
    assert report["frames"] == 2 * GOLDEN.UNSEALED


def test_everything_that_was_recorded_reads_as_it_was(store: Path) -> None:
    with engram.open(store) as memory:
        camera = list(memory[GOLDEN.CAMERA])
        assert [one.time for one in camera] == [GOLDEN.time_at(i) for i in ALL]
        np.testing.assert_array_equal(
            np.stack([one.image for one in camera]), np.stack([GOLDEN.image_at(i) for i in ALL])
        )
        for i, one in enumerate(memory[GOLDEN.JOINTS]):
            value, wanted = dict(one.value), GOLDEN.joints_at(i)
            position = value.pop("position")
            # NumPy's cosines differ in the last bit between processors.
            np.testing.assert_array_max_ulp(position, wanted.pop("position"), maxulp=4)
            assert i > 0 or [float(x).hex() for x in position] == FIRST_POSITION
            assert one.source == "recorded" and idf.equal(value, wanted), i
        spoken = memory[GOLDEN.SPEECH].latest()[0]
        assert spoken.value == {"speaker": "Ada", "text": "Größe?"}


def test_everything_that_was_learned_decodes_as_it_was_measured(store: Path) -> None:
    with engram.open(store, prefer="latent") as memory:
        found = list(memory[GOLDEN.CAMERA])
        assert {one.source for one in found[: GOLDEN.COUNT]} == {"reconstructed"}
        assert {one.source for one in found[GOLDEN.COUNT :]} == {"recorded"}
        for i, one in enumerate(found[: GOLDEN.COUNT]):
            assert one.error is not None
            mse = np.square(one.image.astype(float) - GOLDEN.image_at(i)).mean()
            # Networks round differently on other machines.
            assert mse == pytest.approx(one.error.image_mse, rel=0.02)
        joints = memory[GOLDEN.JOINTS].at(GOLDEN.time_at(7)).value
        np.testing.assert_allclose(
            joints["position"], GOLDEN.joints_at(7)["position"], atol=0.01
        )
        assert joints["image"] == GOLDEN.joints_at(7)["image"]
        assert memory[GOLDEN.CAMERA].ahead(0.2).source == "predicted"


def test_it_goes_on(store: Path) -> None:
    i = ALL.stop
    with engram.record(store) as recorder:
        GOLDEN.record(recorder, i)
    engram.consolidate(store, GOLDEN.CAMERA, reuse_models=True, representation="latents", psnr=24,
                       min_snapshots=2)
    with engram.open(store, prefer="latent") as memory:
        newest = memory[GOLDEN.CAMERA].latest()[0]
        assert (newest.time, newest.source) == (GOLDEN.time_at(i), "reconstructed")
    assert engram.check(store, deep=True)["clean"]


@pytest.fixture
def faded(tmp_path: Path) -> Path:
    shutil.copytree(FOLDER / "faded_1", tmp_path / "robot.engram")
    return tmp_path / "robot.engram"


def test_videos_that_have_faded_are_as_good_as_was_measured(faded: Path) -> None:
    assert engram.check(faded, deep=True)["clean"]
    worst = {"gist": 0.0, "faded": 0.0, "kept": 0.0}
    with engram.open(faded) as memory:
        found = list(memory[FADED.CAMERA])
        assert [one.time for one in found] == [
            FADED.time_at(i) for i in range(FADED.ALL * FADED.ROWS)
        ]
        for i, one in enumerate(found):
            assert one.source == "reconstructed" and one.error is not None
            assert one.value["number"] == pytest.approx(i, abs=1)
            mse = np.square(one.image.astype(float) - FADED.image_at(i)).mean()
            recording = i // FADED.ROWS
            bound = one.instances[0].bound
            form = "gist" if recording < FADED.GISTS else "faded" if bound else "kept"
            assert recording < FADED.FADED or form == "kept"
            worst[form] = max(worst[form], mse)
            if bound:  # It faded from latents.
                assert mse <= bound.image_mse
            else:
                assert mse == pytest.approx(one.error.image_mse, rel=1e-6)
    psnr = {form: 10 * np.log10(255**2 / mse) for form, mse in worst.items()}
    assert psnr["kept"] >= FADED.PSNR_DB
    assert psnr["faded"] >= FADED.FADED_DB
    assert 15 < psnr["gist"] < psnr["faded"]


def test_a_night_begins_from_the_picture_that_is_there(faded: Path) -> None:
    first = FADED.ALL * FADED.ROWS
    with engram.record(faded) as recorder:
        for i in range(first, first + FADED.ROWS):
            value = {"image": FADED.image_at(i), "number": np.float64(i)}
            recorder.commit(FADED.CAMERA, value, FADED.time_at(i))
    engram.consolidate(faded, psnr=FADED.PSNR_DB, representation="video", training=1)
    with engram.open(faded, prefer="latent") as memory:
        newest = memory[FADED.CAMERA].latest()[0]
        assert (newest.time, newest.source) == (FADED.time_at(first + FADED.ROWS - 1), "reconstructed")
    assert engram.check(faded, deep=True)["clean"]


def test_many_entities_read_as_they_were_and_go_on(tmp_path: Path) -> None:
    store = tmp_path / "robot.engram"
    shutil.copytree(FOLDER / "many_1", store)
    assert engram.check(store, deep=True)["clean"]
    with engram.record(store) as recorder:
        for i in range(0, MANY.COUNT, 10):
            recorder.commit(MANY.entity_at(i), MANY.value_at(i, 2), MANY.time_at(i, 2))
    with engram.open(store) as memory:
        for i in range(MANY.COUNT):
            rounds = MANY.ROUNDS + (i % 10 == 0)
            found = list(memory[MANY.entity_at(i)])
            assert [one.time for one in found] == [MANY.time_at(i, at) for at in range(rounds)]
            for at, one in enumerate(found):
                assert idf.equal(one.value, MANY.value_at(i, at)), (i, at)
    assert engram.check(store, deep=True)["clean"]
