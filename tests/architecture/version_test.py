# SPDX-License-Identifier: Apache-2.0
"""The version stands in CMakeLists.txt; every other place that names one says the same."""

import re
import shutil
import tempfile
import unittest
from pathlib import Path

import yaml  # type: ignore[import]

ROOT = Path(__file__).resolve().parents[2]
#: Files that name the version because their readers want it there.
KNOWN = ("CITATION.cff", "CHANGELOG.md", "python/pyproject.toml")
#: What of the sources is searched for constants that nobody listed.
FOLDERS = ("augmentation", "cli", "cmake", "datasets", "encoders", "ltm", "memory", "python",
           "reports", "server", "speech", "training", "viewer")
ENDINGS = {".cpp", ".h", ".in", ".cmake", ".py", ".toml", ".txt"}
_CONSTANT = re.compile(r"^.*version\w*\s*=\s*[\"'](\d+\.\d+\.\d+)[\"']",
                       re.IGNORECASE | re.MULTILINE)


def the_version(root: Path) -> str:
    found = re.search(r"^project\(engram VERSION (\d+\.\d+\.\d+)\b",
                      (root / "CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE)
    if not found:
        raise ValueError("CMakeLists.txt: has no project(engram VERSION ...)")
    return found.group(1)


def version_of_citation(text: str) -> str:
    return str(yaml.safe_load(text)["version"])


def newest_of_changelog(text: str) -> str:
    """The first heading that is a version; `Unreleased` has to stand above it."""
    names = re.findall(r"^## \[([^\]]+)\]", text, re.MULTILINE)
    if names[:1] != ["Unreleased"] or len(names) < 2:
        raise ValueError(f"CHANGELOG.md: headings are {names}, the first has to be Unreleased")
    return names[1]


def problems_of(root: Path) -> list[str]:
    version = the_version(root)
    problems = []
    for name, told in (("CITATION.cff", version_of_citation),
                       ("CHANGELOG.md", newest_of_changelog)):
        found = told((root / name).read_text(encoding="utf-8"))
        if found != version:
            problems.append(f"{name}: says {found}, CMakeLists.txt says {version}")
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix not in ENDINGS or "build" in file.relative_to(root).parts:
                continue
            for found in _CONSTANT.findall(file.read_text(encoding="utf-8")):
                if found != version:
                    problems.append(
                        f"{file.relative_to(root)}: says {found}, CMakeLists.txt says {version}")
    return problems


class Version(unittest.TestCase):
    def test_is_the_same_everywhere(self) -> None:
        self.assertEqual(problems_of(ROOT), [])

    def test_is_found_in_the_python_package(self) -> None:
        text = (ROOT / "python/pyproject.toml").read_text(encoding="utf-8")
        self.assertEqual(_CONSTANT.findall(text), [the_version(ROOT)])


class PlantedFaults(unittest.TestCase):
    def setUp(self) -> None:
        self.scratch = tempfile.TemporaryDirectory(prefix="engram-version-")
        self.root = Path(self.scratch.name)
        for name in ("CMakeLists.txt", *KNOWN):
            (self.root / name).parent.mkdir(exist_ok=True)
            shutil.copy(ROOT / name, self.root / name)

    def tearDown(self) -> None:
        self.scratch.cleanup()

    def test_nothing_is_wrong_with_a_copy(self) -> None:
        self.assertEqual(problems_of(self.root), [])

    def test_another_version_is_found_in_each_place(self) -> None:
        for name in KNOWN:
            path = self.root / name
            good = path.read_text(encoding="utf-8")
            path.write_text(good.replace(the_version(ROOT), "97.0.1"), encoding="utf-8")
            problems = problems_of(self.root)
            self.assertEqual(len(problems), 1, name)
            self.assertTrue(problems[0].startswith(f"{name}: says 97.0.1"), problems[0])
            path.write_text(good, encoding="utf-8")

    def test_a_constant_that_nobody_listed_is_found(self) -> None:
        planted = self.root / "training" / "planted.cpp"
        planted.parent.mkdir()
        planted.write_text('constexpr std::string_view kCodeVersion = "0.0.7";\n', encoding="utf-8")
        self.assertEqual(len(problems_of(self.root)), 1)

    def test_a_changelog_without_unreleased_is_refused(self) -> None:
        with self.assertRaisesRegex(ValueError, "Unreleased"):
            newest_of_changelog("## [0.1.0]\n")


if __name__ == "__main__":
    unittest.main()
