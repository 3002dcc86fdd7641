# SPDX-License-Identifier: Apache-2.0
"""What the C++ side does holds no other thread up."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from conftest import CAMERA, Recorded

import engram
from engram import errors


def moments_meanwhile(work: Callable[[], object]) -> int:
    """How often this thread went on while another did `work`."""
    thread = threading.Thread(target=work)
    moments = 0
    thread.start()
    while thread.is_alive():
        time.sleep(0.001)
        moments += 1
    return moments


def test_a_decode_in_one_thread_does_not_stop_another(learned: Recorded) -> None:
    with engram.open(learned.path) as memory:
        model = memory[CAMERA].model
        latents = model.encode(np.concatenate([learned.images] * 4))
        model.decode(latents)
        # One call: with the lock of Python held there would be one moment before, one after it.
        assert moments_meanwhile(lambda: model.decode(latents)) > 10


def test_queries_of_latents_do_not_stop_another_thread(learned: Recorded) -> None:
    with engram.open(learned.path, prefer="latent") as memory:
        assert moments_meanwhile(lambda: memory.query(f"{CAMERA} @ all")) > 10


def test_checking_and_training_do_not_stop_another_thread(
    learned: Recorded, copied: os.PathLike[str]
) -> None:
    assert moments_meanwhile(lambda: engram.check(learned.path, deep=True)) > 3
    train = {"steps": 20, "width": 16, "threads": 1, "representation": "latents", "psnr": 26}
    assert moments_meanwhile(lambda: engram.consolidate(copied, CAMERA, **train)) > 50


def test_one_memory_may_be_closed_while_another_thread_reads(learned: Recorded) -> None:
    memory = engram.open(learned.path, prefer="latent")
    camera = memory[CAMERA]
    images = []

    def read() -> None:
        try:
            images.extend(one.image for one in camera)
        except errors.FailedPreconditionError:
            pass

    thread = threading.Thread(target=read)
    thread.start()
    memory.close()
    thread.join()
    assert all(image.shape == learned.images[0].shape for image in images)


def test_several_memories_answer_side_by_side(learned: Recorded) -> None:
    def read(_: int) -> int:
        with engram.open(learned.path, prefer="latent") as memory:
            return sum(int(one.image.sum()) for one in memory[CAMERA])

    with ThreadPoolExecutor(3) as pool:
        assert len(set(pool.map(read, range(6)))) == 1


def image_sums(memory: engram.Memory) -> list[int]:
    return [int(one.image.sum()) for one in memory[CAMERA].latest(3)]


def test_memories_are_pickled_by_path(learned: Recorded) -> None:
    with engram.open(learned.path, prefer="latent") as memory:
        copy = pickle.loads(pickle.dumps(memory))
        assert image_sums(copy) == image_sums(memory)
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            assert pool.map(image_sums, [memory]) == [image_sums(memory)]


def test_a_forked_process_is_told_to_open_its_own(learned: Recorded) -> None:
    memory = engram.open(learned.path)
    out, into = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            memory.entities
            os.write(into, b"answered")
        except errors.FailedPreconditionError as error:
            os.write(into, str(error).encode())
        os._exit(0)
    os.close(into)
    os.waitpid(child, 0)
    assert b"another process" in os.read(out, 1000)
    os.close(out)
    assert memory.entities, "and it is as it was here"


def test_wrong_times_have_no_effect_on_others(learned: Recorded) -> None:
    with engram.open(learned.path) as memory, pytest.raises(ValueError):
        memory[CAMERA].at("no time")
