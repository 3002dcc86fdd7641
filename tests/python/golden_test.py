# SPDX-License-Identifier: Apache-2.0
"""The vectors of tests/golden/idf: what C++ wrote, read by Python and written again.

golden_test.py GENERATE_MAIN GOLDEN_DIRECTORY
"""

import sys
import tempfile
import unittest
from pathlib import Path

from generated import generate

from engram import idf


def class_of(value, classes):
    """The class with exactly the members of the value, in their order; None: there is none."""
    for one in classes:
        if isinstance(value, dict) and list(value) == [
            member.name for member in one.idf_type().all_members
        ]:
            return one
    return None


class Golden(unittest.TestCase):
    program = ""
    golden = ""

    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        modules = generate(cls.program, cls.golden, Path(directory.name))
        named = [getattr(module, name) for module in modules for name in module.__all__]
        cls.classes = [one for one in named if issubclass(one, idf.TypedObject)]
        cls.vectors = sorted(Path(cls.golden).glob("*.idf"))

    def test_there_are_vectors(self):
        self.assertGreater(len(self.vectors), 3)
        found = {class_of(idf.decode(path.read_bytes()), self.classes) for path in self.vectors}
        self.assertIn("Scene", {one.__name__ for one in found if one is not None})

    def test_both_forms_are_the_same_value(self):
        for path in self.vectors:
            with self.subTest(path.name):
                data = path.read_bytes()
                value = idf.decode(data)
                text = path.with_suffix(".json").read_text("utf-8")
                self.assertTrue(idf.equal(value, idf.from_json(text)))
                self.assertEqual(idf.encode(value), data)

    def test_objects_write_the_bytes_that_they_read(self):
        for path in self.vectors:
            with self.subTest(path.name):
                data = path.read_bytes()
                one = class_of(idf.decode(data), self.classes)
                self.assertIsNotNone(one, "of no generated class")
                made = one.from_idf(idf.decode(data))
                self.assertEqual(idf.encode(made.to_idf()), data)
                self.assertEqual(made, one.from_idf(idf.decode(data)))


if __name__ == "__main__":
    Golden.golden = sys.argv.pop(2)
    Golden.program = sys.argv.pop(1)
    unittest.main()
