# SPDX-License-Identifier: Apache-2.0
"""Holds the walks of docs/design.md, section 1, against the sources: each names a file and a function of it."""

import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STEP = re.compile(r"^\| `([a-z0-9_/]+\.(?:cpp|h))`: `([A-Za-z_:]+)` \|", re.MULTILINE)


def walks(design):
    """The tables below "The walks", each as a list of (file, function)."""
    section = design.split("### The walks", 1)[1].split("\n## ", 1)[0]
    return [STEP.findall(table) for table in section.split("\n\n") if table.startswith("| ")]


def is_defined(source, function):
    """True where the source defines the function: its name and a parenthesis, at the begin of no call."""
    name = re.escape(function)
    return re.search(rf"^(?!\s*(?:return|//|\*)).*[\s*&:]{name}\((?:[^;]|\n)*?\{{", source, re.MULTILINE)


def rooms_entered_twice(steps):
    rooms = [str(Path(file).parent) for file, _ in steps]
    entered = [room for i, room in enumerate(rooms) if i == 0 or rooms[i - 1] != room]
    return sorted({room for room in entered if entered.count(room) > 1})


class WalksTest(unittest.TestCase):
    def setUp(self):
        self.walks = walks((ROOT / "docs/design.md").read_text(encoding="utf-8"))

    def test_there_are_four_walks_of_several_steps(self):
        self.assertEqual(len(self.walks), 4)
        for steps in self.walks:
            self.assertGreaterEqual(len(steps), 4)

    def test_every_function_is_defined_where_the_page_says(self):
        for steps in self.walks:
            for file, function in steps:
                source = (ROOT / file).read_text(encoding="utf-8")
                self.assertTrue(is_defined(source, function), f"{file} does not define {function}")

    def test_a_function_that_is_only_called_is_not_defined(self):
        self.assertFalse(is_defined("int a() {\n  return b(1);\n}\n", "b"))
        self.assertTrue(is_defined("int C::b(int x) {\n}\n", "C::b"))

    def test_a_walk_enters_each_room_once(self):
        # Working memory gives what leaves it to the service that it lies below.
        self.assertEqual([rooms_entered_twice(steps) for steps in self.walks], [["memory/live"], [], [], []])
        self.assertEqual(rooms_entered_twice([("a/x.cpp", "f"), ("b/y.cpp", "g"), ("a/z.cpp", "h")]), ["a"])


if __name__ == "__main__":
    unittest.main()
