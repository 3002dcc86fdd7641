# SPDX-License-Identifier: Apache-2.0
"""Python and C++ see the same in made-up values, damaged bytes and types.

agreement_test.py RANDOM_VALUES_MAIN
"""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from engram import idf


class Agreement(unittest.TestCase):
    """What random_values_main.cpp wrote, which says what is in its files."""

    program = ""

    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        cls.out = Path(directory.name)
        subprocess.run([cls.program, cls.out], check=True)

    def entries(self, name):
        return idf.decode((self.out / name).read_bytes())

    def test_values_read_from_both_forms_are_the_same(self):
        packed = self.entries("values.idf")
        lines = (self.out / "values.json").read_text("utf-8").split("\n")[:-1]
        self.assertEqual(len(packed), 500)
        self.assertEqual(len(lines), 500)
        for array, line in zip(packed, lines):
            value = idf.decode(array)
            self.assertTrue(idf.equal(value, idf.from_json(line)), line)
            self.assertEqual(idf.encode(value), array.tobytes(), line)

    def test_json_is_printed_alike(self):
        lines = (self.out / "values.json").read_text("utf-8").split("\n")[:-1]
        differing = [line for line in lines if idf.to_json(idf.from_json(line)) != line]
        # The C++ printer finds the shortest digits of a double nearly always.
        self.assertLess(len(differing), 10, differing)

    def test_damaged_bytes_are_refused_for_the_same_reason(self):
        refused = 0
        for entry in self.entries("hostile.idf"):
            message = ""
            try:
                value = idf.decode(entry["bytes"])
                self.assertEqual(idf.encode(value), idf.encode(idf.decode(idf.encode(value))))
            except idf.IdfError as error:
                message = str(error)
            refused += message != ""
            self.assertEqual(message, entry["message"], entry["bytes"].tobytes())
        self.assertGreater(refused, 500)

    def test_types_check_and_cast_alike(self):
        entries = self.entries("types.idf")
        self.assertEqual(len(entries), 1500)
        for entry in entries:
            made = idf.type_from_data(entry["type"])
            self.assertTrue(idf.equal(idf.default_value(made), entry["default"]), made)
            mismatches = idf.check(entry["value"], made)
            self.assertEqual([str(one) for one in mismatches], entry["mismatches"], made)
            value, notes = idf.cast(entry["value"], made)
            self.assertEqual([str(note) for note in notes], entry["notes"], made)
            self.assertTrue(idf.equal(value, entry["cast"]), made)
            self.assertEqual(idf.check(value, made), [])


if __name__ == "__main__":
    Agreement.program = sys.argv.pop(1)
    unittest.main()
