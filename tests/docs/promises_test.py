# SPDX-License-Identifier: Apache-2.0
"""Tests that docs/reliability.md names exist, in the programs that it names."""

from __future__ import annotations

import pathlib
import re
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
_ADDED = re.compile(
    r"(engram_add_test|engram_add_room_test|add_test|engram_add_docs_test)\(([^)]*)\)")
_TEST = re.compile(r"^(?:TEST|TEST_F|TEST_P|TYPED_TEST)\(\s*(\w+),\s*(\w+)\)", re.MULTILINE)


def programs_of(tests: pathlib.Path) -> dict[str, set[str]]:
    """What CMake is told to run, with the tests in its sources."""
    programs: dict[str, set[str]] = {}
    for file in tests.rglob("CMakeLists.txt"):
        text = re.sub(r"#.*", "", file.read_text())
        for function, arguments in _ADDED.findall(text):
            words = re.sub(r"\$<[^>]*>", "", arguments).split()
            words = words[1:] if words[:1] == ["NAME"] else words
            if not words or "$" in words[0]:
                continue
            is_room = function == "engram_add_room_test"
            name = {"engram_add_room_test": f"{words[0]}_test",
                    "engram_add_docs_test": f"docs_{words[0]}"}.get(function, words[0])
            sources = [file.parent / (words[0] if is_room else "") / word
                       for word in words if word.endswith(".cpp")]
            found = programs.setdefault(name, set())
            for source in sources:
                if source.exists():
                    found |= {".".join(one) for one in _TEST.findall(source.read_text())}
    return programs


def problems_of(page: str, programs: dict[str, set[str]]) -> list[str]:
    problems = []
    for line in page.split("\n"):
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        if not line.startswith("| ") or len(cells) != 3 or cells[0] == "promise":
            continue
        promise = cells[0]
        tests = re.findall(r"`(\w+\.\w+)`", cells[1])
        names = re.findall(r"`(\w+)`", cells[2])
        if not names or not (tests or cells[1] == "the whole program"):
            problems.append(f"'{promise}' names no test")
        for name in names:
            if name not in programs:
                problems.append(f"'{promise}': there is no program {name}")
        for test in tests:
            if not any(test in programs.get(name, ()) for name in names):
                problems.append(f"'{promise}': {test} is not in {', '.join(names)}")
    return problems


class Promises(unittest.TestCase):
    def test_are_held_by_tests_that_there_are(self) -> None:
        page = (SOURCE / "docs" / "reliability.md").read_text()
        self.assertEqual(problems_of(page, programs_of(SOURCE / "tests")), [])
        self.assertGreater(page.count("_test` |"), 30)

    def test_without_a_test_are_found(self) -> None:
        programs: dict[str, set[str]] = {"store_test": {"A.B"}, "crash_test": set()}
        page = ("| promise | tests | program |\n|---|---|---|\n| one | `A.B` | `store_test` |\n"
                "| two | the whole program | `crash_test` |\n{}\n")
        self.assertEqual(problems_of(page.format(""), programs), [])
        for line in ("| x | `A.C` | `store_test` |", "| x | `A.B` | `crash_test` |",
                     "| x | the whole program | `gone_test` |", "| x | by hand | `store_test` |",
                     "| x | `A.B` | the store's |"):
            self.assertNotEqual(problems_of(page.format(line), programs), [], line)

    def test_programs_are_found_with_what_is_in_them(self) -> None:
        programs = programs_of(SOURCE / "tests")
        self.assertIn("Journey.PredictsTheFuture", programs["cli_test"])
        self.assertIn("docs_promises_test", programs)
        self.assertGreater(len(programs["store_test"]), 100)


if __name__ == "__main__":
    unittest.main()
