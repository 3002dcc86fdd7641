# SPDX-License-Identifier: Apache-2.0
"""Builds the module with CMake and puts it beside the package's Python files.

ENGRAM_BUILD names a build folder to use (of the preset `release` unless it is configured already);
without it build/release of the sources, which `make build` fills too.
"""

import os
import shutil
import subprocess
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCES = Path(__file__).resolve().parent.parent


class BuildWithCMake(build_ext):
    def build_extension(self, extension: Extension) -> None:
        build = Path(os.environ.get("ENGRAM_BUILD", SOURCES / "build" / "release"))
        if not (build / "build.ninja").exists():
            subprocess.run(
                ["cmake", "--preset", "release", "-S", SOURCES, "-B", build], check=True, cwd=SOURCES
            )
        subprocess.run(["cmake", "--build", build, "--target", "engram_python"], check=True)
        made = next((build / "python" / "engram").glob("_core*.so"))
        target = Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(made, target)


setup(ext_modules=[Extension("engram._core", sources=[])], cmdclass={"build_ext": BuildWithCMake})
