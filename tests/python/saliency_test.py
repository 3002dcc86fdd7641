# SPDX-License-Identifier: Apache-2.0
"""What a snapshot is worth, from Python."""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import engram
from engram.errors import InvalidArgumentError, NotFoundError

CUP = "Objects/Instances/kitchen/cup"
SAID = "Speech/Commands/human/text"
START = 1_600_000_000 * 10**9
STEP = 200_000_000


class SaliencyTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name) / "store.engram"
        with engram.record(cls.path) as recorder:
            for i in range(100):
                position = np.array([0.0 if i < 60 else 0.7, 1.0])
                recorder.commit(CUP, {"position": position}, START + i * STEP)
            recorder.commit(SAID, {"text": "Bring the cup."}, START + 30 * STEP)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def test_explains_what_a_snapshot_is_worth(self) -> None:
        with engram.open(self.path) as memory:
            cup = memory[CUP]
            moved = cup.why_salient(START + 60 * STEP)
            rests = cup.why_salient(START + 40 * STEP)
            self.assertGreater(moved.saliency, rests.saliency)
            self.assertEqual((moved.rank, moved.count), (2, 100))
            self.assertEqual(moved.datetime, np.datetime64(START + 60 * STEP, "ns"))
            self.assertIn("position[0] is 0.7", moved["change"].found)
            self.assertAlmostEqual(sum(one.contribution for one in moved.parts), moved.saliency)
            self.assertEqual(memory[SAID].why_salient()["speech"].value, 1)
            with self.assertRaises(KeyError):
                moved["beauty"]
            with self.assertRaises(NotFoundError):
                cup.why_salient(START + 1)

    def test_a_rule_keeps_what_is_salient(self) -> None:
        copy = self.path.with_name("copy.engram")
        shutil.copytree(self.path, copy)
        subprocess.run([ENGRAM, "why-salient", copy, CUP, "--keep", "--json"], check=True,
                       capture_output=True)
        config = copy.with_name("forget.yaml")
        config.write_text("forget: {rules: [{saliency: {keep: 0.1}}]}")
        engram.forget(copy, config=config, dry_run=False)
        with engram.open(copy) as memory:
            times = memory[CUP].times()
            self.assertLess(len(times), 15)
            self.assertIn(np.datetime64(START + 60 * STEP, "ns"), times)
            self.assertTrue(memory[CUP].why_salient().is_stored)
        config.write_text("forget: {rules: [{saliency: {keep: 10}}]}")
        with self.assertRaises(InvalidArgumentError):
            engram.forget(copy, config=config, dry_run=False)


if __name__ == "__main__":
    ENGRAM = sys.argv.pop(1)
    unittest.main()
