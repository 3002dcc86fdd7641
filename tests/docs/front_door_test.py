#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The C++ program of README.md is the one that tests/consumer builds against an installation and runs."""

import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class FrontDoorTest(unittest.TestCase):
    def test_the_readme_shows_the_program_that_is_run(self):
        readme = (ROOT / "README.md").read_text(encoding="utf-8")
        blocks = re.findall(r"^```cpp\n(.*?)^```$", readme, re.MULTILINE | re.DOTALL)
        shown = [block for block in blocks if "Memory::open" in block]
        self.assertEqual(len(shown), 1)
        source = (ROOT / "tests/consumer/front_door.cpp").read_text(encoding="utf-8")
        self.assertIn(shown[0], source)


if __name__ == "__main__":
    unittest.main()
