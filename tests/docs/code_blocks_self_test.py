# SPDX-License-Identifier: Apache-2.0
"""What runs the documentation's blocks notices each kind of block that does not do what it says.

`engram` is a script here, so that nothing is built or recorded.
"""

from __future__ import annotations

import contextlib
import io
import pathlib
import tempfile
import unittest

import code_blocks_test
from document_run import DocumentReport, Tools, lines_not_in, run_document
from fixtures import Fixtures
from markdown_blocks import DocumentError, blocks_of

_ENGRAM = """#!/bin/sh
case "$1" in
  fail) echo "error: it failed" >&2; exit 1 ;;
  serve) echo listens; exec sleep 100 ;;
  crash) echo listens; sleep 0.3; exit 7 ;;
  *) echo "engram was asked: $*" ;;
esac
"""


class CodeBlocks(unittest.TestCase):
    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        engram = self.folder / "engram"
        engram.write_text(_ENGRAM)
        engram.chmod(0o755)
        self.tools = Tools(engram, self.folder, ".", self.folder / "compile_commands.json")

    def run_text(self, text: str, tools: Tools | None = None) -> DocumentReport:
        (self.folder / "page.md").write_text(text)
        tools = tools or self.tools
        fixtures = Fixtures(self.folder / "fixtures", tools.engram, self.folder)
        with tempfile.TemporaryDirectory(dir=self.folder) as box:
            return run_document(self.folder / "page.md", "page.md", pathlib.Path(box, "box"),
                                tools, fixtures)

    def assert_fails(self, text: str, message: str) -> None:
        report = self.run_text(text)
        self.assertEqual(len(report.failures), 1, report)
        self.assertIn(message, report.failures[0])

    def assert_runs(self, text: str, **counts: int) -> None:
        report = self.run_text(text)
        self.assertEqual(report.failures, [])
        self.assertEqual(dict(report.counts), counts)

    def test_commands_share_a_folder_and_find_the_program(self) -> None:
        page = "```sh\nengram info > said\n```\n\n```sh\ngrep 'asked: info' said\n```\n"
        self.assert_runs(page, run=2)

    def test_a_command_that_fails_fails(self) -> None:
        self.assert_fails("# T\n\n```sh\nengram fail\necho on\n```\n", "page.md:3: sh: exit code 1")
        self.assert_fails("```sh\nfalse | true\n```\n", "exit code 1")
        self.assert_fails("```sh\necho $nothing\n```\n", "unbound")

    def test_an_exit_code_is_the_one_that_is_told(self) -> None:
        self.assert_runs("<!-- run: exits 1 -->\n```sh\nengram fail\n```\n", run=1)
        self.assert_fails("<!-- run: exits 1 -->\n```sh\ntrue\n```\n", "exit code 0, needs 1")

    def test_what_is_not_run_has_a_reason(self) -> None:
        report = self.run_text("<!-- not run: needs\na robot -->\n```sh\nfalse\n```\n")
        self.assertEqual((report.failures, report.left_out), ([], ["page.md:3: sh: needs a robot"]))
        self.assert_fails("<!-- not run: -->\n```sh\nfalse\n```\n", "needs a reason")

    def test_a_block_needs_a_language_that_is_known(self) -> None:
        self.assert_fails("```\nengram info\n```\n", "language ''")
        self.assert_fails("```bash\nengram info\n```\n", "language 'bash'")
        self.assert_fails("Text:\n\n    engram info\n", "indented code block")
        self.assert_fails("```text\nengram info\n```\n", "begins like a command")
        self.assert_fails("```sh\nengram info\n", "has no end")

    def test_orders_are_known_and_belong_to_a_block(self) -> None:
        self.assert_fails("<!-- run: twice -->\n```sh\ntrue\n```\n", "unknown order 'twice'")
        self.assert_fails("<!-- run: exits 1 -->\nText\n", "no block follows")
        self.assert_fails("<!-- run: exits 1 -->\n", "no block follows")
        self.assert_fails("<!-- run: replace a => b -->\n```sh\ntrue\n```\n", "'a', which is not")
        self.assert_fails("<!-- run: setup nothing -->\n```sh\ntrue\n```\n", "no fixture 'nothing'")
        self.assert_runs("<!-- a remark -->\n```sh\ntrue\n```\n", run=1)

    def test_python_keeps_its_names_from_block_to_block(self) -> None:
        self.assert_runs("```python\na = 1\n```\n\n```python\nassert a == 1\n```\n", run=2)
        self.assert_runs("```sh\ntouch f\n```\n\n```python\nopen('f').close()\n```\n", run=2)

    def test_python_that_raises_fails_with_its_line(self) -> None:
        self.assert_fails("```python\na = 1\nraise KeyError(a)\n```\n", 'File "page.md", line 3')
        self.assert_fails("```python\nimport sys; sys.exit(0)\n```\n", "SystemExit")
        self.assert_fails("```python\nimport os; os._exit(0)\n```\n", "interpreter ended")
        self.assert_fails("```python\n>>> 1 + 1\n3\n```\n", "Expected")
        self.assert_runs("```python\n>>> 1 + 1\n2\n```\n", run=1)

    def test_python_is_left_out_only_where_there_is_no_module(self) -> None:
        without = Tools(self.tools.engram, self.folder, "", self.tools.compile_commands)
        report = self.run_text("```python\nraise KeyError\n```\n", without)
        self.assertEqual(report.failures, [])
        self.assertIn("no Python module", report.left_out[0])

    def test_data_that_cannot_be_read_fails(self) -> None:
        self.assert_runs("```yaml\na: {b: 1}\n```\n\n```xml\n<a/>\n```\n", parsed=2)
        self.assert_runs('```json\n{"a": 1}\n{"a": 2}\n```\n\n```ini\n[U]\nA=%h\n```\n', parsed=2)
        self.assert_fails("```yaml\na: {b\n```\n", "is no yaml")
        self.assert_fails('```json\n{"a": }\n```\n', "is no json")
        self.assert_fails("```xml\n<a>\n```\n", "is no xml")
        self.assert_fails("```ini\nA=1\n```\n", "is no ini")

    def test_a_file_is_given_to_the_program(self) -> None:
        page = "<!-- run:\nwrite a.yaml\nafter grep {} a.yaml\n-->\n```yaml\na: 1\n```\n"
        self.assert_runs(page.format("a:"), **{"read by the program": 1})
        self.assert_fails(page.format("b:"), "exit code 1")

    def test_cmake_and_cpp_are_looked_at(self) -> None:
        self.assert_fails("```cmake\nno_such_command()\n```\n", "no_such_command")
        flags = self.tools.compile_commands
        flags.write_text('[{"file": "a.cpp", "command": "c++ -std=c++20 -c a.cpp '
                         '-o cli/CMakeFiles/engram_program.dir/a.cpp.o"}]')
        self.assert_runs("```cpp\nint a = 1;\n```\n", compiled=1)
        self.assert_fails("```cpp\nint a = ;\n```\n", "page.md:2:9: error")

    def test_shown_output_was_printed(self) -> None:
        page = "```sh\nengram info 12 MB\n```\n\n<!-- run: shown -->\n```text\n{}\n```\n"
        same = "$ engram info\nengram was  asked: info 7 kB"
        self.assert_runs(page.format(same), run=1, compared=1)
        self.assert_runs(page.format("engram was...\n..."), run=1, compared=1)
        self.assert_fails(page.format("engram was asked: info 7 dB"), "was not printed")
        self.assertEqual(lines_not_in("one\ntwo 2", "one\ntwo 33"), [])
        self.assertEqual(lines_not_in("one\nthree", "one\ntwo"), ["three"])

    def test_what_runs_in_the_background_lives_until_the_end(self) -> None:
        page = ("<!-- run: background until listens -->\n```sh\nengram {}\n```\n\n"
                "```sh\nsleep 0.5\n```\n")
        self.assert_runs(page.format("serve"), run=2)
        self.assert_fails(page.format("crash"), "ended by itself with 7")
        report = self.run_text(page.format("info"))
        self.assertIn("before 'listens'", report.failures[0])

    def test_the_whole_documentation_is_looked_for(self) -> None:
        (self.folder / "docs" / "howto").mkdir(parents=True)
        for name in ("README.md", "docs/a.md", "docs/howto/b.md"):
            (self.folder / name).write_text("```sh\nfalse\n```\n")
        names = code_blocks_test.documents_of(self.folder)
        self.assertEqual(names, ["README.md", "docs/a.md", "docs/howto/b.md"])
        with contextlib.redirect_stdout(io.StringIO()):
            reports = code_blocks_test.run_all(names, self.tools, self.folder / "all")
        self.assertEqual([len(report.failures) for report in reports], [1, 1, 1])
        self.assertIn("3 failed", code_blocks_test.summary(reports))

    def test_lists_may_hold_blocks(self) -> None:
        (self.folder / "page.md").write_text("* a\n\n  ```sh\n  true\n  ```\n\n  more\n")
        self.assertEqual(blocks_of(self.folder / "page.md", "page.md")[0].text, "true\n")
        (self.folder / "page.md").write_text("<!-- open\n")
        with self.assertRaises(DocumentError):
            blocks_of(self.folder / "page.md", "page.md")


if __name__ == "__main__":
    unittest.main()
