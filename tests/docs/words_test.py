# SPDX-License-Identifier: Apache-2.0
"""One word for one thing: options of commands, keys of configurations and keywords of Python.

Reads the references, which other tests compare with the program and the package.
"""

from __future__ import annotations

import pathlib
import re
import unittest

DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"

#: Words of earlier versions: what reads them warns, and no help shows them.
OLD_OPTIONS = {"--output", "--type-name"}

#: Options whose values say something else in each command: when a write is on the disk, when a
#: commit counts as done.
DIFFERENT = {"--durability"}

#: Options of `engram consolidate` that Python calls otherwise: it takes several there.
PLURALS = {"entities": "--entity"}

_OPTION = re.compile(r"^  (?:-\w,)?(--[\w-]+)(?:,--[\w-]+)*( TEXT:\{([^}]*)\})?")


def options() -> dict[str, dict[str, set[str]]]:
    """By command: its options, and the values that each may have (none: any)."""
    found: dict[str, dict[str, set[str]]] = {}
    for part in (DOCS / "reference" / "cli.md").read_text().split("\n## ")[1:]:
        command = found.setdefault(part.split("\n", 1)[0], {})
        for line in part.split("\n"):
            if match := _OPTION.match(line):
                command[match[1]] = set((match[3] or "").split(",")) - {""}
    return found


def row_of(page: str, key: str) -> str:
    """The row of a key in a table."""
    return next(line for line in (DOCS / page).read_text().split("\n")
                if line.startswith(f"| `{key}`"))


def signature_of(function: str) -> str:
    text = (DOCS / "reference" / "python.md").read_text()
    return next(line for line in text.split("\n") if line.startswith((f"{function}(", f"* `{function}(")))


class Words(unittest.TestCase):
    def setUp(self) -> None:
        self.commands = options()
        self.assertGreater(len(self.commands), 20)

    def test_old_words_are_not_shown(self) -> None:
        for command, known in self.commands.items():
            self.assertFalse(OLD_OPTIONS & set(known), command)

    def test_an_option_has_the_same_values_everywhere(self) -> None:
        """Some commands may know more of them."""
        values: dict[str, list[tuple[str, set[str]]]] = {}
        for command, known in self.commands.items():
            for option, choices in known.items():
                if choices and option not in DIFFERENT:
                    values.setdefault(option, []).append((command, choices))
        self.assertIn("--prefer", values)
        for option, uses in values.items():
            longest = max((choices for _, choices in uses), key=len)
            for command, choices in uses:
                self.assertLessEqual(choices, longest, f"{command} {option}")

    def test_files_of_types_and_their_names_are_told_apart_by_one_word_each(self) -> None:
        for command, known in self.commands.items():
            if "--type" in known:
                self.assertIn("--types", known, command)

    def test_what_is_written_anew_goes_out(self) -> None:
        for command in ("recover", "augment", "export"):
            self.assertIn("--out", self.commands[f"engram {command}"])

    def test_what_answers_has_the_same_words_in_configurations_and_python(self) -> None:
        words = self.commands["engram query"]["--prefer"]
        self.assertEqual(words, {"recorded", "latent"})
        named = set(re.findall(r"`([^`]*)`", row_of("server.md", "prefer"))) - {"prefer"}
        self.assertEqual(named, words)
        python = (DOCS.parent / "python" / "engram" / "doors.py").read_text()
        self.assertEqual(set(re.findall(r'"(\w+)": (?:False|True)', python)), words)

    def test_a_server_is_told_the_same_by_options_and_by_its_file(self) -> None:
        for option in ("name", "store", "mode", "durability", "recording", "preset", "prior",
                       "listen"):
            if option != "store":  # Which is an argument.
                self.assertIn(f"--{option}", self.commands["engram serve"])
            self.assertTrue(any(f"`{option}`" in line.split("|")[1]
                                for line in (DOCS / "server.md").read_text().split("\n")
                                if line.startswith("| `")), option)
        for key in ("certificate", "key", "client_ca", "tokens"):
            self.assertIn("--" + key.replace("_", "-"), self.commands["engram serve"])
            self.assertIn(f"`{key}`", row_of("server.md", "security"))

    def test_a_night_is_told_the_same_in_python(self) -> None:
        keywords = re.findall(r"(\w+): ", signature_of("consolidate"))
        self.assertIn("reuse_models", keywords)
        for keyword in set(keywords) - {"store", "progress"}:
            option = PLURALS.get(keyword, "--" + keyword.replace("_", "-"))
            self.assertIn(option, self.commands["engram consolidate"])

    def test_the_last_moment_that_is_known_is_the_same_in_python(self) -> None:
        self.assertIn("--at", self.commands["engram predict"])
        for function in ("predict", "engines"):
            self.assertIn("at: TimeLike", signature_of(function))


if __name__ == "__main__":
    unittest.main()
