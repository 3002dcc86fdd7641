# SPDX-License-Identifier: Apache-2.0
"""No status is thrown away: each is passed on, handled or logged. The compiler finds those that are
forgotten ([[nodiscard]]); this finds casts that silence it."""

import json
import re
import unittest
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
#: Tests, fuzzers and experiments call what fails on purpose.
ROOMS = ("augmentation", "cli", "datasets", "encoders", "ltm", "memory", "python", "reports",
         "server", "speech", "training", "viewer")
#: A function or method of ours, or gRPC's, that says whether it could.
_DECLARED = re.compile(r"\b(?:Status|Result<[^;{}()=]*>)&?\s+(?:\w+::)*(\w+)\s*\(")
_CAST = re.compile(r"(?:\(void\)|static_cast<void>\(|\bstd::ignore\s*=)\s*([^;]*);")
#: Calls that only look at a status: the one before it is what is thrown away.
_LOOKS = {"ok", "status", "code", "message"}
_CALL = re.compile(r"(\w+)\s*\(")
_COMMENT = re.compile(r"//.*")
_MAYBE = re.compile(r"\[\[maybe_unused\]\]\s*(?:const\s+)?(?:Status|Result<[^=;]*>)\s+\w+")


def declared(texts: list[str]) -> set[str]:
    """Names of functions that return a Status or a Result."""
    return {name for text in texts for name in _DECLARED.findall(text)}


def thrown_away(text: str, names: set[str]) -> list[str]:
    """Expressions that drop what one of these functions returns."""
    text = _COMMENT.sub("", text)
    found = _MAYBE.findall(text)
    for cast in _CAST.finditer(text):
        expression = " ".join(cast.group(1).split())
        # What the standard library calls so is not ours.
        calls = _CALL.findall(re.sub(r"\bstd::\w+", "", expression))
        while calls and calls[-1] in _LOOKS:
            calls.pop()
        if any(call in names for call in calls):
            found.append(expression)
    return found


def sources() -> dict[str, str]:
    return {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8")
            for room in ROOMS for path in sorted((ROOT / room).rglob("*"))
            if path.suffix in (".h", ".cpp")}


def presets_without_errors() -> list[str]:
    """Presets that build although the compiler says that a status is forgotten."""
    presets = json.loads((ROOT / "CMakePresets.json").read_text(encoding="utf-8"))
    known = {preset["name"]: preset for preset in presets["configurePresets"]}

    def variable(preset: dict[str, Any], name: str) -> str:
        if name in preset.get("cacheVariables", {}):
            return str(preset["cacheVariables"][name])
        return variable(known[preset["inherits"]], name) if "inherits" in preset else ""

    return [name for name, preset in known.items() if not preset.get("hidden")
            and variable(preset, "CMAKE_COMPILE_WARNING_AS_ERROR") != "ON"
            and "-Werror=unused-result" not in variable(preset, "CMAKE_CXX_FLAGS")]


class Statuses(unittest.TestCase):
    def test_none_is_thrown_away(self) -> None:
        texts = sources()
        names = declared(list(texts.values()))
        self.assertGreater(len(names), 300, "the expression finds functions")
        self.assertIn("remove_file", names)
        for name, text in texts.items():
            with self.subTest(name):
                self.assertEqual(thrown_away(text, names), [])

    def test_the_compiler_says_so_where_one_is_forgotten(self) -> None:
        status = (ROOT / "ltm/core/status.h").read_text(encoding="utf-8")
        self.assertRegex(status, r"class \[\[nodiscard\]\] Status \{")
        self.assertRegex(status, r"class \[\[nodiscard\]\] Result \{")
        for preset in presets_without_errors():
            self.fail(f"preset '{preset}' lets a status be forgotten")


class Search(unittest.TestCase):
    NAMES = declared(["Status sync();", "[[nodiscard]] Result<std::vector<int>> A::read(int at) {",
                      "void notify();"])

    def test_knows_functions_by_what_they_return(self) -> None:
        self.assertEqual(self.NAMES, {"sync", "read"})

    def test_finds_casts_of_any_form(self) -> None:
        for text in ("(void)file.sync();", "static_cast<void>(read(3).ok());",
                     "std::ignore = journal->sync();", "(void)read(3).status();",
                     "if (a)\n  (void)\n      file.sync();"):
            self.assertEqual(len(thrown_away(text, self.NAMES)), 1, text)
        self.assertEqual(len(thrown_away("[[maybe_unused]] const Status s = sync();", self.NAMES)),
                         1)

    def test_lets_other_casts_pass(self) -> None:
        for text in ("(void)notify();", "(void)index;", "// (void)sync();",
                     "const Status status = sync();"):
            self.assertEqual(thrown_away(text, self.NAMES), [], text)


if __name__ == "__main__":
    unittest.main()
