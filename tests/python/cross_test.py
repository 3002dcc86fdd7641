# SPDX-License-Identifier: Apache-2.0
"""An object of generated C++ comes to generated Python, is changed, and goes back.

cross_test.py KITCHEN_MAIN GENERATE_MAIN GOLDEN_DIRECTORY
"""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from generated import generate

from engram import idf


class Cross(unittest.TestCase):
    kitchen_main = ""
    program = ""
    golden = ""

    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        cls.out = Path(directory.name)
        cls.kitchen, cls.thing = generate(cls.program, cls.golden, cls.out)
        subprocess.run([cls.kitchen_main, "write", cls.out / "scene.idf"], check=True)

    def scene(self):
        return self.kitchen.Scene.from_idf(idf.decode((self.out / "scene.idf").read_bytes()))

    def test_members_are_what_cpp_said(self):
        scene = self.scene()
        self.assertEqual(scene.stamp, 1_645_189_616_492_182_001)
        self.assertEqual(scene.cup.name, "blue cup")
        self.assertIs(scene.cup.material, self.thing.Material.STEEL)
        self.assertIs(scene.cup.last_fill, self.kitchen.Fill.class_)
        self.assertEqual(np.float32(scene.cup.height), np.float32(0.12))
        self.assertEqual(scene.cup.seen_in[0], "Vision/RGB/head/cam/2022-02-18 13:06:56.492182/0")
        self.assertEqual(scene.cup.pose_world_thing.position.tolist(), [1.5, -2, 0.25])
        self.assertEqual(scene.maybe_cup.name, "Tasse für Käthe")
        self.assertEqual(scene.fills["größte"], self.kitchen.Fill.EMPTY)
        self.assertEqual(scene.numbers.a_string, 'Tee "grün" 茶 🍵\n\t\\ \x01')
        self.assertEqual(scene.numbers.a_double, 3.141592653589793)
        self.assertEqual(scene.arrays.matrix_3_4[2, 3], 11.125)
        self.assertEqual(scene.arrays.matrix_1_3.tolist(), [[7, 8, 9]])
        self.assertEqual(scene.arrays.pose_world_f64.orientation.tolist(), [0.6, 0.8, 0, 0])
        self.assertEqual(scene.containers.maybe_pair[0], 3)
        self.assertEqual(scene.containers.maybe_pair[1].name, "inner")
        self.assertEqual(scene.containers.maybe_strings, ["a", None, ""])
        row, value = np.mgrid[0:5, 0:21]
        self.assertTrue(np.array_equal(scene.sensors.rgb.reshape(5, 21), 7 * row + value + 1))

    def test_changes_arrive_at_cpp(self):
        scene = self.scene()
        scene.stamp += 1
        scene.cup.name += " of Python"
        scene.cup.fill = self.kitchen.Fill.None_
        position = scene.cup.pose_world_thing.position.copy()
        position[1] = 7.5
        scene.cup.pose_world_thing.position = position
        scene.maybe_cup = None
        scene.cups.append(scene.cup)
        scene.fills = dict(sorted({**scene.fills, "neu": self.kitchen.Fill.EMPTY}.items()))
        scene.numbers.maybe_double = 1e-300
        scene.arrays.matrix_3_4 = np.asfortranarray(2 * scene.arrays.matrix_3_4)
        scene.sensors.rgb = scene.sensors.rgb.copy()
        scene.sensors.rgb[1, 2, 0] = 200
        scene.words.class__ = -5
        path = self.out / "changed.idf"
        path.write_bytes(idf.encode(scene.to_idf()))
        subprocess.run([self.kitchen_main, "check", path], check=True)

    def test_cpp_sees_where_nothing_was_changed(self):
        run = subprocess.run(
            [self.kitchen_main, "check", self.out / "scene.idf"], capture_output=True, check=False
        )
        self.assertEqual(run.returncode, 1)
        self.assertIn(b"is not as it was made", run.stderr)


if __name__ == "__main__":
    Cross.golden = sys.argv.pop(3)
    Cross.program = sys.argv.pop(2)
    Cross.kitchen_main = sys.argv.pop(1)
    unittest.main()
