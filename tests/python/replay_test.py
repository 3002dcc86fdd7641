# SPDX-License-Identifier: Apache-2.0
"""A store as the memory that it was, from Python."""

import pathlib
import tempfile
import unittest

import engram
from engram.errors import FailedPreconditionError, InvalidArgumentError, NotFoundError

JOINT = "Robot/State/arm/joint"
CUP = "Objects/Things/table/cup"
START = 1_600_000_000 * 10**9
SECOND = 10**9


class ReplayTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name) / "store.engram"
        with engram.record(cls.path) as recorder:
            for i in range(100):
                recorder.commit(JOINT, {"x": 0.1 * i}, START + i * SECOND // 10)
                if i % 10 == 0:
                    recorder.commit(CUP, {"n": i}, START + i * SECOND // 10)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def test_shows_nothing_of_what_came_later(self) -> None:
        with engram.replay(self.path, START + 5 * SECOND, paused=True) as memory:
            joint = memory[JOINT]
            self.assertEqual(joint.last, START + 5 * SECOND)
            self.assertEqual(len(memory.query(f"{JOINT} @ all")[JOINT]), 51)
            ahead = memory.query(f"{JOINT} @ +200ms")[JOINT][0]
            self.assertEqual(ahead.source, "predicted")
            self.assertAlmostEqual(ahead.value["x"], 5.2, places=3)
            memory.replaying.seek(START + 2 * SECOND)
            self.assertEqual(joint.last, START + 2 * SECOND)
            self.assertEqual(memory[CUP].last, START + 2 * SECOND)

    def test_is_controlled(self) -> None:
        with engram.replay(self.path, paused=True) as memory:
            replaying = memory.replaying
            self.assertEqual(replaying.state.now, START)
            self.assertEqual(replaying.state.stores, (str(self.path),))
            with memory.watch("Robot", timeout=20) as watch:
                replaying.step()
                event = watch.next()
                self.assertEqual((event.time, event.value["x"]), (START + SECOND // 10, 0.1))
                replaying.set_speed(20)
                replaying.play()
                times = [watch.next().time for _ in range(98)]
            self.assertEqual(times, [START + i * SECOND // 10 for i in range(2, 100)])
            replaying.pause()
            replaying.repeat(START, START + SECOND)
            self.assertEqual(replaying.state.loop, (START, START + SECOND))
            replaying.repeat()
            self.assertIsNone(replaying.state.loop)
            replaying.seek(START + 100 * SECOND)
            with self.assertRaises(NotFoundError):
                replaying.step()

    def test_keeps_commits_apart(self) -> None:
        with engram.replay(self.path, START + SECOND, paused=True) as memory:
            memory.commit("Plans/a/b/c", {"go": True})
            self.assertTrue(memory.query("Plans @ latest")["Plans/a/b/c"][0].value["go"])
        with engram.open(self.path) as memory:
            self.assertNotIn("Plans/a/b/c", memory)

    def test_refuses_what_is_not(self) -> None:
        with self.assertRaisesRegex(InvalidArgumentError, "before the first snapshot"):
            engram.replay(self.path, START - 1)
        with self.assertRaisesRegex(InvalidArgumentError, "speed of 0"):
            engram.replay(self.path, speed=0)
        with self.assertRaisesRegex(InvalidArgumentError, "ends later"):
            engram.replay(self.path, loop=(START + SECOND, START))
        with self.assertRaises(NotFoundError):
            engram.replay(self.path / "none")
        with engram.open(self.path) as memory:
            with self.assertRaisesRegex(FailedPreconditionError, "is no replay"):
                memory.replaying.pause()
        with engram.replay(self.path, paused=True) as memory:
            with self.assertRaisesRegex(InvalidArgumentError, "before the first snapshot"):
                memory.replaying.seek(0)
            with self.assertRaises(InvalidArgumentError):
                memory.replaying.repeat(START)


if __name__ == "__main__":
    unittest.main()
