# SPDX-License-Identifier: Apache-2.0
"""Classes generated from tests/golden/idf/kitchen.xml.

generate_test.py GENERATE_MAIN GOLDEN_DIRECTORY
"""

import enum
import os
import py_compile
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from generated import generate

from engram import idf


class Generated(unittest.TestCase):
    program = ""
    golden = ""

    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        cls.out = Path(directory.name)
        cls.kitchen, cls.thing = generate(cls.program, cls.golden, cls.out)
        modules = (cls.kitchen, cls.thing)
        every = {name: getattr(module, name) for module in modules for name in module.__all__}
        cls.enums = [one for one in every.values() if issubclass(one, enum.IntEnum)]
        cls.objects = [one for one in every.values() if issubclass(one, idf.TypedObject)]

    def test_types_are_those_of_the_cpp_side(self):
        stored = idf.decode((self.out / "types.idf").read_bytes())
        classes = {one.idf_type().name: one for one in self.enums + self.objects}
        self.assertEqual(set(classes), set(stored))
        for name, data in stored.items():
            self.assertEqual(classes[name].idf_type(), idf.type_from_data(data), name)

    def test_new_objects_have_the_defaults_of_their_types(self):
        for one in self.objects:
            value = one().to_idf()
            self.assertEqual(idf.check(value, one.idf_type()), [], one)
            self.assertTrue(idf.equal(value, idf.default_value(one.idf_type())), one)

    def test_defaults_are_not_shared(self):
        first, second = self.kitchen.Scene(), self.kitchen.Scene()
        first.cups.append(self.kitchen.Cup())
        first.arrays.position[0] = 1
        first.containers.two_turns[0][0] = 5
        self.assertEqual(second, self.kitchen.Scene())
        self.assertNotEqual(first, second)
        self.assertEqual(first.containers.two_turns[1][0], 1)

    def test_values_come_back_as_they_went(self):
        scene = self.kitchen.Scene(stamp=5)
        scene.cup = self.kitchen.Cup(name="ü", fill=self.kitchen.Fill.FULL, seen_in=["a/b"])
        scene.fills = {"x": self.kitchen.Fill.None_}
        scene.numbers.a_float = float("nan")
        scene.arrays.pose_world_f64 = idf.Pose.from_matrix(np.eye(4), np.float64)
        scene.containers.maybe_pair = (3, self.kitchen.Cup(height=0.5))
        scene.words.class__ = 1
        scene.words.class_ = 2
        value = scene.to_idf()
        self.assertEqual(idf.at(value, "words/class"), 1)
        self.assertEqual(idf.at(value, "words/class_"), 2)
        read = self.kitchen.Scene.from_idf(idf.decode(idf.encode(value)))
        self.assertEqual(read, scene)
        self.assertIs(read.fills["x"], self.kitchen.Fill.None_)
        self.assertIsInstance(read.containers.maybe_pair[1], self.kitchen.Cup)
        self.assertEqual(idf.encode(read.to_idf()), idf.encode(value))

    def test_numbers_are_written_by_the_type(self):
        value = self.kitchen.Numbers(an_int=1).to_idf()
        kinds = {key: idf.kind_name(part) for key, part in value.items()}
        self.assertEqual(kinds["an_int"], "int32")
        self.assertEqual(kinds["a_long"], "int64")
        self.assertEqual(kinds["a_float"], "float32")
        self.assertEqual(kinds["a_double"], "float64")
        self.assertEqual(kinds["a_time"], "int64")
        self.assertEqual(kinds["maybe_int"], "none")

    def test_images_and_clouds_are_not_copied(self):
        sensors = self.kitchen.Sensors(
            rgb=np.zeros((48, 64, 3), np.uint8), cloud_xyz=np.zeros((100, 3), np.float32)
        )
        value = sensors.to_idf()
        self.assertTrue(np.shares_memory(value["rgb"], sensors.rgb))
        self.assertTrue(np.shares_memory(value["cloud_xyz"], sensors.cloud_xyz))
        data = idf.encode(value)
        read = self.kitchen.Sensors.from_idf(idf.decode(data))
        self.assertTrue(np.shares_memory(read.rgb, np.frombuffer(data, np.uint8)))
        self.assertTrue(np.shares_memory(read.cloud_xyz, np.frombuffer(data, np.uint8)))

    def test_arrays_in_any_memory_order_are_taken(self):
        image = np.arange(48 * 3, dtype=np.uint8).reshape(8, 6, 3)[::-1, ::2]
        read = self.kitchen.Sensors.from_idf(self.kitchen.Sensors(rgb=image).to_idf())
        self.assertTrue(np.array_equal(read.rgb, image))

    def test_a_core_class_reads_what_a_provider_extended(self):
        cup = self.kitchen.Cup(name="mug", material=self.thing.Material.GLASS)
        read = self.thing.Thing.from_idf(cup.to_idf())
        self.assertIs(type(read), self.thing.Thing)
        self.assertEqual(read.name, "mug")

    def test_missing_optional_members_are_absent(self):
        value = self.kitchen.Cup().to_idf()
        del value["borrower"]
        self.assertIsNone(self.kitchen.Cup.from_idf(value).borrower)

    def test_everything_that_does_not_fit_is_told(self):
        value = self.kitchen.Cup().to_idf() | {"height": "tall", "fill": np.int32(9)}
        del value["name"]
        value["pose_world_thing"]["position"] = np.zeros(2, np.float32)
        with self.assertRaises(idf.IdfError) as caught:
            self.kitchen.Cup.from_idf(value)
        for part in ("'name'", "'height'", "'fill'", "'pose_world_thing/position'"):
            self.assertIn(part, str(caught.exception))

    def test_wrong_members_are_told_by_path(self):
        scene = self.kitchen.Scene(cups=[self.kitchen.Cup(height="tall")])
        with self.assertRaisesRegex(idf.IdfError, "'cups/0/height': found string 'tall'"):
            scene.to_idf()

    def test_a_class_of_ones_own_reads_itself(self):
        class Mug(self.kitchen.Cup):
            pass

        self.assertIs(type(Mug.from_idf(Mug(name="a").to_idf())), Mug)

    def test_modules_compile_and_lines_are_short(self):
        for path in self.out.glob("*.py"):
            py_compile.compile(str(path), cfile=str(self.out / "x.pyc"), doraise=True)
            text = path.read_text("utf-8")
            long = [line for line in text.splitlines() if len(line) > 100 and "doc=" not in line]
            self.assertEqual(long, [])
            self.assertRegex(text, r"\A# Generated from \w+\.xml by engram idf generate")

    def test_documentation_is_carried_over(self):
        self.assertIn('with "quotes", a */ and a \\ at the end \\', self.kitchen.Cup.__doc__)
        text = (self.out / "kitchen.py").read_text("utf-8")
        self.assertIn("Unit: m. Range: 0..1.", text)
        self.assertIn("Shape: [4, 6, 3], rgb24.", text)

    @unittest.skipUnless(shutil.which("mypy"), "mypy is not installed")
    def test_types_are_consistent(self):
        package = os.environ["PYTHONPATH"].split(":")[0]
        run = subprocess.run(
            ["mypy", "--strict", "--cache-dir", self.out / "cache", *self.out.glob("*.py")],
            env={**os.environ, "MYPYPATH": f"{package}:{self.out}"},
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(run.returncode, 0, run.stdout)


if __name__ == "__main__":
    Generated.golden = sys.argv.pop(2)
    Generated.program = sys.argv.pop(1)
    unittest.main()
