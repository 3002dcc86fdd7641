# SPDX-License-Identifier: Apache-2.0
"""Models that are looked into, and what they reconstruct."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from conftest import CAMERA, COUNT, JOINTS, SPEECH, Recorded

import engram
from engram import errors


def test_models_are_listed_with_what_they_are(learned: Recorded, recorded: Recorded) -> None:
    with engram.open(learned.path) as memory:
        models = memory.models()
        assert [(model.entity, model.version) for model in models] == [(JOINTS, 1), (CAMERA, 1)]
        model = memory[CAMERA].model
        assert repr(model).startswith(f"<Model {CAMERA} v1: ")
        assert model.about["snapshots"] == COUNT
        assert model.about["seed"] == 1 and model.about["variant"] == "rate"
        coarse, fine = model.grids["image"]
        assert coarse[1:] == (3, 3) and fine[1:] == (6, 6)
        assert model.numbers == []
        assert model.step_seconds == pytest.approx(0.2)
        with pytest.raises(errors.NotFoundError, match="consolidate"):
            _ = memory[SPEECH].model
    with engram.open(recorded.path) as memory:
        assert memory.models() == []


def test_reconstructions_say_what_they_are_and_how_wrong(learned: Recorded) -> None:
    with engram.open(learned.path, prefer="latent") as memory:
        for snapshot, image in zip(memory[CAMERA], learned.images, strict=True):
            assert (snapshot.source, snapshot.model) == ("reconstructed", "Vision/RGB/head/cam v1")
            error = np.square(snapshot.image.astype(float) - image).mean()
            assert snapshot.error is not None
            assert snapshot.error.image_mse == pytest.approx(error, rel=1e-6)
            assert snapshot.error.psnr_db == pytest.approx(10 * np.log10(255**2 / error))
        joints = memory[JOINTS].latest()[0]
        assert joints.source == "reconstructed" and joints.error.rmse < 0.1
        assert memory[SPEECH].latest()[0].source == "recorded"
    with engram.open(learned.path) as memory:
        assert {snapshot.source for snapshot in memory[CAMERA]} == {"recorded"}


def test_latents_of_images_are_those_of_the_store(learned: Recorded) -> None:
    with engram.open(learned.path) as memory:
        camera = memory[CAMERA]
        made, stored = camera.model.encode(learned.images), camera.latents()
        np.testing.assert_array_equal(made.array, stored.array)
        np.testing.assert_array_equal(np.asarray(made), made.images["image"])
        assert made.array.dtype == np.int32 and len(made) == COUNT
        assert stored.times[0] == np.datetime64(learned.times[0], "ns")
        assert stored.is_latent["image"].all()
        some = camera.latents(learned.times[5], learned.times[7])
        np.testing.assert_array_equal(some.array, stored.array[5:8])
        assert len(camera.model.encode(camera.snapshots())) == COUNT, "snapshots are values"


def test_decoded_latents_are_what_a_query_answers(learned: Recorded) -> None:
    with engram.open(learned.path, prefer="latent") as memory:
        model = memory[CAMERA].model
        images = model.decode(model.encode(learned.images))
        assert images.shape == learned.images.shape and images.dtype == np.uint8
        np.testing.assert_array_equal(images, np.stack([one.image for one in memory[CAMERA]]))
        np.testing.assert_array_equal(images, model.images(model.encode(learned.images)))


def test_changed_latents_give_changed_images(learned: Recorded) -> None:
    with engram.open(learned.path) as memory:
        model = memory[CAMERA].model
        latents = model.encode(learned.images[:2])
        changed = latents.array.copy()
        changed[0] += 3
        images = model.decode(dataclasses.replace(latents, images={"image": changed}))
        before = model.decode(latents)
        assert np.abs(images[0].astype(int) - before[0]).mean() > 1
        np.testing.assert_array_equal(images[1], before[1])
        rounded = model.decode(dataclasses.replace(latents, images={"image": changed + 0.3}))
        np.testing.assert_array_equal(rounded, images)
        for wrong in (changed[:, :-1], changed[:1], changed.astype(str), changed * np.nan):
            with pytest.raises(ValueError):
                model.decode(dataclasses.replace(latents, images={"image": wrong}))
        with pytest.raises(errors.InvalidArgumentError, match="image"):
            model.decode(dataclasses.replace(latents, images={}))


def test_numbers_are_values_and_come_back(learned: Recorded) -> None:
    with engram.open(learned.path) as memory:
        model, snapshots = memory[JOINTS].model, memory[JOINTS].latest(4)
        latents = model.encode(snapshots)
        assert latents.array.shape == (4, 0)
        assert model.numbers == ["position", "position", "position", "load", "is_moving"]
        assert latents.numbers.shape == (4, 5)
        decoded = model.decode(latents)
        np.testing.assert_allclose(decoded[3]["position"], snapshots[3].value["position"])
        with pytest.raises(errors.InvalidArgumentError, match="needs values"):
            model.encode(learned.images)


def test_what_has_another_layout_is_refused(learned: Recorded) -> None:
    with engram.open(learned.path) as memory:
        model = memory[CAMERA].model
        for wrong in (learned.images[:, ::2], learned.images[..., :1]):
            with pytest.raises(errors.InvalidArgumentError):
                model.encode(wrong)
        with pytest.raises(errors.InvalidArgumentError, match="shape"):
            model.encode(learned.images[0])
        assert len(model.encode([])) == 0


def test_predictions_tell_how_wrong_they_may_be(learned: Recorded) -> None:
    with engram.open(learned.path) as memory:
        ahead = memory[CAMERA].model.predict(learned.images[:2], 3)
        assert [one.steps for one in ahead] == [1, 2, 3]
        for one in ahead:
            assert one.value["image"].shape == learned.images[0].shape
            assert one.error.image_mse is not None and one.error.image_mse > 0
            # Few snapshots tell no bound.
            assert one.bound.image_mse is None or one.bound.image_mse >= one.error.image_mse
        with pytest.raises(errors.InvalidArgumentError):
            memory[CAMERA].model.predict(learned.images[:2], 0)
        with pytest.raises(errors.InvalidArgumentError):
            memory[CAMERA].model.predict([], 1)


def test_weights_are_named_arrays_that_cannot_be_written(learned: Recorded) -> None:
    with engram.open(learned.path) as memory:
        weights = memory[CAMERA].model.weights
        assert sum(array.size for array in weights.values()) > 10_000
        background = next(array for name, array in weights.items() if name.endswith("background"))
        assert background.dtype == np.float32 and background.ndim == 4
        with pytest.raises(ValueError):
            background[0, 0, 0, 0] = 1
        assert any(np.count_nonzero(array) for array in weights.values())


def test_the_training_curve_shows_how_it_went(learned: Recorded) -> None:
    with engram.open(learned.path) as memory:
        curve = memory[CAMERA].model.training_curve
        assert set(curve) == {"phase", "step", "seconds", "loss", "psnr_db", "bytes"}
        assert list(dict.fromkeys(curve["phase"])) == ["autoencoder", "dynamics", "motion"]
        coding = curve["phase"] == "autoencoder"
        assert (np.diff(curve["step"][coding]) > 0).all()
        psnr = curve["psnr_db"][coding]
        assert psnr[-1] > psnr[0], "it learned"
        assert not curve["seconds"].any(), "the same steps give the same file"


def test_codes_are_near_where_images_are_alike(learned: Recorded) -> None:
    with engram.open(learned.path) as memory:
        codes = memory[CAMERA].model.global_codes(learned.images[[0, 18, 9]])
    assert codes.shape == (3, 48) and codes.dtype == np.float32
    # The square comes back after 18 steps.
    assert np.linalg.norm(codes[0] - codes[1]) < np.linalg.norm(codes[0] - codes[2])


def test_errors_are_columns(learned: Recorded) -> None:
    with engram.open(learned.path, prefer="latent") as memory:
        errors_of = memory[CAMERA].errors()
        assert list(errors_of["time"].astype(np.int64)) == learned.times
        assert set(errors_of["form"]) == {"latents"} and set(errors_of["model"]) == {1}
        told = [one.error.psnr_db for one in memory[CAMERA]]
        np.testing.assert_allclose(errors_of["psnr_db"], told)
        assert (errors_of["bytes"] > 0).all() and np.isnan(errors_of["rmse"]).all()
        assert (memory[JOINTS].errors()["rmse"] < 0.1).all()
        assert len(memory[SPEECH].errors()["time"]) == 0


def test_the_future_of_a_past_moment_is_predicted_without_knowing_it(learned: Recorded) -> None:
    start = learned.times[20]
    with engram.open(learned.path) as memory:
        camera = memory[CAMERA]
        ahead = camera.predict([0.2, 0.6], start)
        assert [one.time for one in ahead] == [learned.times[21], learned.times[23]]
        assert {one.source for one in ahead} == {"predicted"}
        copied = camera.predict(0.4, start, engine="copy-last")[0]
        np.testing.assert_array_equal(copied.image, learned.images[20])
        assert copied.predictor == "copy-last"
        engines = camera.engines(0.2)
        assert {"deep", "copy-last"} <= {one.name for one in engines}
        assert engines[0].name == camera.ahead(0.2).predictor
        with pytest.raises(errors.NotFoundError, match="copy-last"):
            camera.predict(0.2, engine="oracle")
        with pytest.raises(errors.InvalidArgumentError):
            camera.predict(-0.2)
        joints = memory[JOINTS].predict(0.2)[0]
        assert joints.value["position"].shape == (3,)
