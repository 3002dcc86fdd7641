# SPDX-License-Identifier: Apache-2.0
"""Memories as data sets of PyTorch, in this process and in workers."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from conftest import CAMERA, COUNT, JOINTS, Recorded, time_at

import engram

torch = pytest.importorskip("torch")
from engram.torch import SnapshotDataset, number_tensor  # noqa: E402


def stacked(loader: object) -> np.ndarray:
    return np.concatenate([batch.numpy() for batch in loader]).transpose(0, 2, 3, 1)


def test_items_are_images_by_their_place(recorded: Recorded) -> None:
    images = SnapshotDataset(recorded.path, CAMERA)
    assert len(images) == COUNT
    assert images[3].shape == (3, 40, 48) and images[3].dtype == torch.uint8
    np.testing.assert_array_equal(images[-1].numpy().transpose(1, 2, 0), recorded.images[-1])
    with pytest.raises(IndexError):
        images[COUNT]
    assert len(SnapshotDataset(recorded.path, CAMERA, time_at(3), time_at(5))) == 3


@pytest.mark.parametrize("workers", [0, 2])
def test_workers_read_what_this_process_reads(recorded: Recorded, workers: int) -> None:
    images = SnapshotDataset(recorded.path, CAMERA)
    loader = torch.utils.data.DataLoader(images, batch_size=5, num_workers=workers)
    for _ in range(2):
        np.testing.assert_array_equal(stacked(loader), recorded.images)


@pytest.mark.parametrize("start", ["fork", "spawn"])
def test_workers_decode_after_this_process_did(learned: Recorded, start: str) -> None:
    """OpenMP's threads do not survive a fork: workers must not wait for them."""
    images = SnapshotDataset(learned.path, CAMERA, prefer="latent")
    expected = np.stack([images[i].numpy() for i in range(COUNT)]).transpose(0, 2, 3, 1)
    with engram.open(learned.path) as memory:
        model = memory[CAMERA].model
        model.decode(model.encode(learned.images))
    loader = torch.utils.data.DataLoader(
        images, batch_size=5, num_workers=2, multiprocessing_context=start, timeout=60
    )
    difference = stacked(loader).astype(int) - expected
    assert np.abs(difference).max() <= 1, "other numbers of threads round differently"


def test_numbers_are_tensors_too(recorded: Recorded) -> None:
    joints = SnapshotDataset(recorded.path, JOINTS, transform=number_tensor)
    assert joints[2].shape == (5,) and joints[2].dtype == torch.float32
    np.testing.assert_allclose(joints[2][:3], np.sin(np.arange(3) + 0.2), rtol=1e-6)


def test_it_is_pickled_without_what_is_open(recorded: Recorded) -> None:
    images = SnapshotDataset(recorded.path, CAMERA)
    _ = images[0]
    copy = pickle.loads(pickle.dumps(images))
    np.testing.assert_array_equal(copy[1].numpy(), images[1].numpy())


def test_what_was_forgotten_is_named(copied: object) -> None:
    images = SnapshotDataset(copied, CAMERA)
    gone = (7, COUNT - 1)  # Behind the last one that stays there would be predictions.
    engram.forget(copied, [f"{CAMERA} @ {time_at(i)}" for i in gone], dry_run=False)
    for i in gone:
        with pytest.raises(engram.EngramError, match="forgotten since"):
            images[i]
    assert images[6].shape == (3, 40, 48)
