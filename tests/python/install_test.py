# SPDX-License-Identifier: Apache-2.0
"""Installs the package by CMake and by pip, and uses it from there: install_test.py BUILD SOURCES."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCES = pathlib.Path(sys.argv.pop()).resolve()
BUILD = pathlib.Path(sys.argv.pop()).resolve()
USE = """
import engram, sys
with engram.record(sys.argv[1]) as recorder:
    recorder.commit("A/B/C/d", {"x": 1.5}, 10**18)
with engram.open(sys.argv[1]) as memory:
    assert memory["A/B/C/d"].latest()[0].value == {"x": 1.5}
print(engram.__file__)
"""


def run(*words, **options):
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False, **options)
    if done.returncode != 0:
        raise AssertionError(f"{words}: ended with {done.returncode}\n{done.stdout}")
    return done.stdout


class Installing(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def uses(self, python, **environment):
        """Where the package was found."""
        return run(python, "-c", USE, self.folder / "a.engram", cwd=self.folder,
                   env={"PATH": os.environ["PATH"], "HOME": str(self.folder), **environment})

    def test_cmake_installs_it_below_its_prefix(self):
        run("cmake", "--install", BUILD, "--prefix", self.folder / "prefix")
        found = next((self.folder / "prefix").glob("lib/python3*/dist-packages"))
        self.assertTrue((found / "engram" / "py.typed").exists())
        self.assertFalse(list(found.rglob("CMakeLists.txt")))
        self.assertIn(str(found), self.uses(sys.executable, PYTHONPATH=str(found)))

    def test_pip_installs_it_into_an_environment(self):
        # Of a copy: pip leaves files in the sources.
        for name in ("python", "CMakeLists.txt"):
            source, target = SOURCES / name, self.folder / "sources" / name
            target.parent.mkdir(exist_ok=True)
            if source.is_dir():
                shutil.copytree(source, target, ignore=shutil.ignore_patterns("build", "*.egg-info"))
            else:
                shutil.copy(source, target)
        environment = self.folder / "environment"
        run(sys.executable, "-m", "venv", "--system-site-packages", environment)
        run(environment / "bin" / "pip", "install", "--no-build-isolation", "--no-index",
            self.folder / "sources" / "python", env={**os.environ, "ENGRAM_BUILD": str(BUILD)})
        self.assertIn(str(environment), self.uses(environment / "bin" / "python"))


if __name__ == "__main__":
    unittest.main()
