# SPDX-License-Identifier: Apache-2.0
"""The sources keep to docs/design.md, section 3, and the checker finds where they would not."""

import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import floors

ROOT = Path(__file__).resolve().parents[2]
SPDX = "// SPDX-License-Identifier: Apache-2.0\n"


class Floors(unittest.TestCase):
    def test_sources_include_only_what_their_floor_may(self):
        self.assertEqual(floors.check_floors(ROOT), [])

    def test_sources_have_licence_guard_and_moderate_length(self):
        self.assertEqual(floors.check_style(ROOT), [])

    def test_the_table_names_the_rooms_that_there_are(self):
        rooms = floors.read_table((ROOT / "docs/design.md").read_text(encoding="utf-8"))
        for path in (ROOT / "ltm").iterdir():
            if path.is_dir():
                self.assertIn(f"ltm/{path.name}", rooms)
        self.assertEqual(floors.closure(rooms, "ltm/memory"), {"ltm/memory", "ltm/idf", "ltm/core"})
        self.assertNotIn("encoders", floors.closure(rooms, "ltm/recall"))
        self.assertIn("ltm/h5", floors.closure(rooms, "cli"))

    def test_no_arrow_goes_up_and_there_is_no_circle(self):
        pairs = floors.arrows(ROOT)
        self.assertIn(("ltm/store", "ltm/h5"), pairs)
        self.assertEqual(floors.arrows_up(ROOT, pairs), [])
        self.assertEqual(floors.circle_in(pairs), [])

    def test_an_arrow_up_and_a_circle_are_found(self):
        wrong = {("ltm/core", "ltm/store"), ("ltm/store", "ltm/h5"), ("ltm/h5", "ltm/core")}
        self.assertEqual(floors.arrows_up(ROOT, wrong), [("ltm/core", "ltm/store")])
        self.assertEqual(floors.circle_in(wrong), ["ltm/core", "ltm/h5", "ltm/store"])
        self.assertEqual(floors.circle_in(wrong - {("ltm/h5", "ltm/core")}), [])

    def test_python_stands_beside_the_program_and_not_above_it(self):
        rooms = floors.read_table((ROOT / "docs/design.md").read_text(encoding="utf-8"))
        self.assertNotIn("cli", floors.closure(rooms, "python"))
        self.assertNotIn("python", floors.closure(rooms, "cli"))
        for both in ("reports", "reports/plain", "training/night", "server", "ltm/recall"):
            self.assertIn(both, floors.closure(rooms, "python"))
            self.assertIn(both, floors.closure(rooms, "cli"))

    def test_fuzzers_are_built_with_all_rooms_that_they_need(self):
        """Of the build of fuzzers alone, which nobody makes every day."""
        text = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
        block = re.search(r"if\(ENGRAM_FUZZ\)(.*?)return\(\)", text, re.DOTALL)[1]
        added = set(re.findall(r"add_subdirectory\((\S+)\)", block))
        self.assertIn("tests/fuzz", added)
        pairs = floors.arrows(ROOT)
        missing = {below for above, below in pairs
                   if above in added and not below.startswith("ltm/") and below not in added}
        self.assertEqual(missing if "ltm" in added else {"ltm"}, set())

    def test_plain_reports_need_nothing_that_learns(self):
        rooms = floors.read_table((ROOT / "docs/design.md").read_text(encoding="utf-8"))
        self.assertNotIn("encoders", floors.closure(rooms, "reports/plain"))
        self.assertNotIn("training/night", floors.closure(rooms, "reports/plain"))

    def test_a_name_that_means_nothing_is_refused(self):
        table = "## 3. Rooms and floors\n\n| `ltm/core` | x | boost |\n"
        with self.assertRaisesRegex(ValueError, "boost"):
            floors.read_table(table)


class PlantedFaults(unittest.TestCase):
    """A copy of the sources with one fault: the checker fails and names file and line."""

    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory(prefix="engram-floors-")
        self.root = Path(self.scratch.name)
        (self.root / "docs").mkdir()
        shutil.copy(ROOT / "docs/design.md", self.root / "docs")
        shutil.copytree(ROOT / "ltm", self.root / "ltm")

    def tearDown(self):
        self.scratch.cleanup()

    def check(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
        checker = Path(__file__).with_name("floors.py")
        done = subprocess.run([sys.executable, checker, self.root], capture_output=True, text=True,
                              check=False)
        return done.returncode, done.stdout.strip().splitlines()

    def expect(self, path, text, line, part):
        code, problems = self.check(path, text)
        self.assertEqual(code, 1)
        self.assertEqual(len(problems), 1, problems)
        self.assertTrue(problems[0].startswith(f"{path}:{line}: "), problems[0])
        self.assertIn(part, problems[0])

    def test_nothing_is_wrong_with_a_fine_file(self):
        text = SPDX + '#include "ltm/core/status.h"\n#include <fmt/format.h>\n#include <sys/stat.h>\n'
        self.assertEqual(self.check("ltm/idf/planted.cpp", text)[0], 0)

    def test_an_upward_include(self):
        self.expect("ltm/idf/planted.cpp", SPDX + '\n#include "ltm/store/manifest.h"\n', 3,
                    "ltm/idf may not include ltm/store")

    def test_a_sideward_include(self):
        self.expect("ltm/codec/planted.cpp", SPDX + '#include "ltm/h5/h5.h"\n', 2, "ltm/h5")

    def test_hdf5_outside_of_its_room(self):
        self.expect("ltm/store/planted.cpp", SPDX + "#  include <hdf5.h>\n", 2, "stays in ltm/h5")

    def test_a_library_that_the_row_does_not_name(self):
        self.expect("ltm/core/planted.cpp", SPDX + "#include <opencv2/core.hpp>\n", 2, "OpenCV")
        self.expect("ltm/core/planted.cpp", SPDX + "#include <folly/any.h>\n", 2, "no library")

    def test_learning_below_its_floor(self):
        self.expect("ltm/recall/planted.cpp", SPDX + "#include <torch/torch.h>\n", 2, "LibTorch")

    def test_the_python_module_and_the_program_beside_each_other(self):
        self.expect("python/bindings/planted.cpp", SPDX + '#include "cli/command.h"\n', 2,
                    "python may not include cli")
        (self.root / "python/bindings/planted.cpp").unlink()
        self.expect("cli/planted.cpp", SPDX + '#include "python/bindings/values.h"\n', 2,
                    "cli may not include python")

    def test_options_of_commands_in_a_report(self):
        self.expect("reports/planted.cpp", SPDX + "#include <CLI/CLI.hpp>\n", 2, "stays in cli")

    def test_an_include_beside_the_file(self):
        self.expect("ltm/core/planted.cpp", SPDX + '#include "status.h"\n', 2, "root of the repository")

    def test_missing_licence_guard_and_moderation(self):
        self.expect("ltm/core/planted.cpp", "\n\n\n" + SPDX, 1, "SPDX")
        self.expect("ltm/core/planted.cpp", SPDX + "\n" * 600, 601, "longer than 600")
        self.check("ltm/core/planted.cpp", SPDX)
        self.expect("ltm/core/planted.h", SPDX, 1, "#pragma once")


if __name__ == "__main__":
    unittest.main()
