# SPDX-License-Identifier: Apache-2.0
"""Doxygen understands every comment of the public headers: cpp_reference_test.py OUTPUT."""

from __future__ import annotations

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
OUTPUT = sys.argv.pop()


def doxygen(source: pathlib.Path, output: str) -> subprocess.CompletedProcess[str]:
    pathlib.Path(output).mkdir(parents=True, exist_ok=True)
    settings = (SOURCE / "docs" / "Doxyfile").read_text() + f"\nOUTPUT_DIRECTORY = {output}\n"
    return subprocess.run(["doxygen", "-"], input=settings, cwd=source, capture_output=True,
                          text=True, check=False)


class CppReference(unittest.TestCase):
    def test_of_all_headers_is_made_without_a_warning(self) -> None:
        done = doxygen(SOURCE, OUTPUT)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        page = pathlib.Path(OUTPUT, "html", "classengram_1_1ltm_1_1Recorder.html").read_text()
        self.assertIn("The online phase", page)

    def test_of_a_comment_that_is_wrong_fails(self) -> None:
        with tempfile.TemporaryDirectory() as scratch:
            source = pathlib.Path(scratch)
            rooms = ("ltm", "encoders", "augmentation", "datasets", "training", "server")
            for name in ("docs", *rooms):
                (source / name).mkdir()
            for name in ("cpp_api.md", "doxygen.sed"):
                shutil.copy(SOURCE / "docs" / name, source / "docs" / name)
            (source / "ltm" / "wrong.h").write_text("/// @param b There is none.\nint f(int a);\n")
            done = doxygen(source, str(source / "out"))
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("wrong.h", done.stderr)


if __name__ == "__main__":
    unittest.main()
