# SPDX-License-Identifier: Apache-2.0
"""docs/reference/cli.md is what the program says, and documents name no option that it lacks.

command_reference_test.py ENGRAM
"""

from __future__ import annotations

import pathlib
import re
import sys
import unittest

from code_blocks_test import SOURCE, documents_of

sys.path.insert(0, str(SOURCE / "docs"))

import generate_command_reference as generator  # noqa: E402

ENGRAM = sys.argv.pop()
_MENTION = re.compile(r"engram ((?:[a-z]+ )*[a-z]+)([^`|&;>]*)")
_OPTION = re.compile(r"(?<![\w-])(--[a-z0-9][a-z0-9-]*)")


def unknown_options(text: str, helps: dict[str, str]) -> list[str]:
    """Options that a text gives to commands of `engram` which do not have them."""
    unknown = []
    joined = text.replace("\\\n", " ")
    for words, rest in _MENTION.findall(joined):
        names = words.split(" ")
        while names and " ".join(names) not in helps:
            names.pop()
        if not names:
            continue
        command = " ".join(names)
        known = set(_OPTION.findall(helps[command])) | {"--help", "--version"}
        unknown += [f"engram {command} {option}" for option in _OPTION.findall(rest.split("\n")[0])
                    if option not in known]
    return unknown


class CommandReference(unittest.TestCase):
    commands: list[tuple[tuple[str, ...], str]]
    helps: dict[str, str]

    @classmethod
    def setUpClass(cls) -> None:
        cls.commands = generator.commands_of(ENGRAM)
        cls.helps = {" ".join(command): text for command, text in cls.commands}

    def test_is_what_the_program_says(self) -> None:
        is_current = generator.REFERENCE.read_text() == generator.reference_of(self.commands)
        self.assertTrue(is_current, "is out of date: run make reference")

    def test_has_every_command(self) -> None:
        for command in ("import", "simulate kitchen", "idf generate", "serve", "recover"):
            self.assertIn(command, self.helps)

    def test_documents_name_options_that_there_are(self) -> None:
        found = [f"{name}: {one}" for name in documents_of(SOURCE)
                 for one in unknown_options((SOURCE / name).read_text(), self.helps)]
        self.assertEqual(found, [])

    def test_finds_an_option_that_there_is_not(self) -> None:
        text = "`engram info s --shiny` and `engram simulate kitchen \\\n --depth --deep`"
        self.assertEqual(unknown_options(text, self.helps),
                         ["engram info --shiny", "engram simulate kitchen --deep"])


if __name__ == "__main__":
    unittest.main()
