# SPDX-License-Identifier: Apache-2.0
"""Executes the notebooks on a short kitchen, in their order: notebooks_test.py ENGRAM NOTEBOOKS."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

NOTEBOOKS = pathlib.Path(sys.argv.pop()).resolve()
ENGRAM = pathlib.Path(sys.argv.pop()).resolve()
MAX_BYTES = 500_000


def outputs_of(notebook):
    return [output for cell in notebook["cells"] for output in cell.get("outputs", [])]


class Notebooks(unittest.TestCase):
    names = sorted(path.name for path in NOTEBOOKS.glob("*.ipynb"))

    def test_all_of_them_run(self):
        self.assertEqual(len(self.names), 5)
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for path in NOTEBOOKS.glob("*.*"):
                shutil.copy(path, folder)
            environment = {
                **os.environ, "PATH": f"{ENGRAM.parent}:/usr/bin:{os.environ['PATH']}",
                "HOME": name, "ENGRAM_SECONDS": "16", "ENGRAM_BUDGET": "4",
            }
            environment.pop("MPLBACKEND", None)  # Pictures are the notebook's, not a window's.
            for notebook in self.names:
                with self.subTest(notebook):
                    done = subprocess.run(
                        [sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute",
                         "--inplace", "--ExecutePreprocessor.timeout=300", notebook],
                        cwd=folder, env=environment, stdout=subprocess.PIPE,
                        stderr=subprocess.STDOUT, text=True, check=False)
                    self.assertEqual(done.returncode, 0, done.stdout[-3000:])
                    run = json.loads((folder / notebook).read_text())
                    self.assertTrue(any("image/jpeg" in output.get("data", {})
                                        for output in outputs_of(run)), "it shows pictures")

    def test_what_is_kept_of_them_is_whole_and_small(self):
        for name in self.names:
            with self.subTest(name):
                text = (NOTEBOOKS / name).read_text()
                self.assertLess(len(text), MAX_BYTES)
                notebook = json.loads(text)
                code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
                self.assertTrue(all(cell["execution_count"] for cell in code), "all cells ran")
                self.assertGreater(len(outputs_of(notebook)), 3)
                for output in outputs_of(notebook):
                    self.assertNotEqual(output["output_type"], "error")
                    self.assertNotIn("stderr", output.get("name", ""), "warnings are mended")
                for place in ("/home/", "/root/", "/tmp/", "/work/"):
                    self.assertNotIn(place, text)


if __name__ == "__main__":
    unittest.main()
