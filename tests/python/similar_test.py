# SPDX-License-Identifier: Apache-2.0
"""Moments like another one, from Python."""

import pathlib
import tempfile
import unittest

import numpy as np

import engram
import engram.errors

CAMERA = "Vision/RGB/head/cam"
JOINTS = "RobotState/Proprioception/arm/joints"
START = 1_600_000_000 * 10**9
STEP = 200_000_000
HOUR = 3600 * 10**9
MOMENTS = 60


def image_of(i: int, room: int) -> np.ndarray:
    """A square that goes to the right and comes back, in a room."""
    image = np.full((48, 64, 3), 40 + 30 * room, np.uint8)
    image[:: 6 + room] += 20
    left = 2 + 2 * (i % 40 if i % 40 < 20 else 40 - i % 40)
    image[20:34, left : left + 14] = 120 + 40 * room
    return image


class SimilarTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name) / "store.engram"
        with engram.record(cls.path) as recorder:
            for room in range(2):
                for i in range(MOMENTS):
                    time = START + room * HOUR + i * STEP
                    recorder.commit(CAMERA, {"image": image_of(i, room)}, time)
                    recorder.commit(JOINTS, {"position": np.array([0.1 * i, 1.0])}, time)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def test_equal_images_are_at_one_place_of_a_map(self) -> None:
        for door in (engram.open(self.path), engram.open(self.path, read_only=False)):
            with door as memory:
                made = memory[CAMERA].map()
                self.assertEqual((len(made), made.known), (2 * MOMENTS, 2 * MOMENTS))
                self.assertEqual(len(memory[CAMERA].map(40)), 40)
                self.assertEqual(made.times.dtype, np.int64)
                self.assertTrue((np.diff(made.times) > 0).all())
                self.assertEqual(set(made.recordings), {0, 1})
                # The square comes back the way it went.
                for axis in (made.x, made.y):
                    np.testing.assert_allclose(axis[1:20], axis[39:20:-1], atol=1e-4)
                    self.assertGreater(axis[:MOMENTS].std(), 0.05)
                self.assertTrue(0.3 < made.explained <= 1.0001, made.explained)
                self.assertEqual(memory[JOINTS].map().space, "numbers")
                with self.assertRaises(engram.errors.InvalidArgumentError):
                    memory[CAMERA].map(0)

    def test_finds_moments_like_one_or_like_an_image(self) -> None:
        with engram.open(self.path) as memory:
            camera = memory[CAMERA]
            found = camera.similar(START + 30 * STEP, 5, apart=0.4)
            self.assertEqual(len(found), 5)
            self.assertEqual(found.compared, 2 * MOMENTS)
            self.assertTrue(found.space.startswith("images "))
            distances = [one.distance for one in found]
            self.assertEqual(distances, sorted(distances))
            self.assertNotIn(START + 30 * STEP, [one.time for one in found])
            as_seen = camera.similar(image_of(10, 0), 1)
            self.assertEqual(as_seen[0].distance, 0)
            self.assertEqual(as_seen[0].datetime, np.datetime64(as_seen[0].time, "ns"))
            elsewhere = camera.similar(START, 3, elsewhere=True)
            self.assertTrue(all(one.recording[0] == START + HOUR for one in elsewhere))

    def test_compares_numbers_and_other_entities_beside(self) -> None:
        with engram.open(self.path) as memory:
            joints = memory[JOINTS]
            self.assertEqual(joints.similar(START + 9 * STEP, 1, elsewhere=True)[0].time,
                             START + HOUR + 9 * STEP)
            both = memory[CAMERA].similar(START + 9 * STEP, 1, elsewhere=True,
                                          beside={JOINTS: 1000.0})
            self.assertEqual(both[0].time, START + HOUR + 9 * STEP)
            self.assertIn("numbers", both.space)

    def test_says_what_is_wrong(self) -> None:
        with engram.open(self.path) as memory:
            camera = memory[CAMERA]
            with self.assertRaisesRegex(engram.EngramError, "the moment before it is"):
                camera.similar(START + 1)
            with self.assertRaisesRegex(engram.EngramError, "found an image of 16 x 16 x 3"):
                camera.similar(np.zeros((16, 16, 3), np.uint8))
            self.assertEqual(len(camera.similar(np.zeros((16, 16, 3), np.uint8), any_size=True)), 10)
            with self.assertRaisesRegex(engram.EngramError, "nobody"):
                camera.similar(START, beside={"Vision/RGB/head/nobody": 1.0})
            with self.assertRaises(engram.EngramError):
                camera.similar(START, among="sometimes @")


if __name__ == "__main__":
    unittest.main()
