# SPDX-License-Identifier: Apache-2.0
"""One thing has one word (docs/design.md, section 6): in identifiers, in the names of headers, and at the
begin of help texts."""

import io
import re
import tokenize
import unittest
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
IGNORED = {"build", "shared", "golden", ".git"}

# A word that identifiers do not have, and the one that they have instead.
WORDS = {
    "most": "max",
    "least": "min",
    "forecast": "prediction",
    "forecaster": "predictor",
    "foresight": "bound coverage",
    "outlook": "prediction request",
}
# Identifiers that keep such a word, and why: it means no maximum or minimum there.
ALLOWED = {
    "most_confident": "the confidence of the most confident instance",
    "most_gainful": "the entity whose removal gains most",
    "most_common_layout": "the layout of more values than any other",
    "_most_moved": "the thing that moved farther than any other",
}
# Help texts of options do not begin so: the first two say Max or Min, the others what they count.
BEGINNINGS = ("Most", "Least", "So many", "So much")
# Header names that two folders may have, and why.
ALLOWED_HEADERS = {}

CPP = re.compile(
    r"""//(?:[^\n\\]|\\.)*|/\*.*?\*/
    |(?:u8|u|U|L)?R"(?P<end>[^(\s]*)\(.*?\)(?P=end)"
    |"(?:\\.|[^"\\\n])*"
    |[0-9](?:'?[0-9A-Za-z_.])*
    |'(?:\\.|[^'\\\n])+'
    |\bTEST(?:_F|_P)?\(\s*\w+,\s*\w+\s*\)
    |(?P<name>[A-Za-z_]\w*)""",
    re.DOTALL | re.VERBOSE,
)


def cpp_names(text):
    """Identifiers of C++ with their lines; sentences that name tests, comments and strings have none."""
    for match in CPP.finditer(text):
        if match["name"]:
            yield match["name"], text.count("\n", 0, match.start()) + 1


def python_names(text):
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.NAME:
            yield token.string, token.start[0]


def parts(name):
    """kMaxBytes -> k, max, bytes."""
    return [part.lower() for part in re.findall(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])", name)]


def cpp_texts(text):
    """String literals of C++ with their lines; literals that follow each other are one text. Help texts
    often reach add_option() through another function, so all literals are looked at. Raw strings, which
    are longer texts, are left out."""
    joined, line, end = "", 0, 0
    for match in CPP.finditer(text):
        if joined and text[end:match.start()].strip():
            yield joined, line
            joined = ""
        if match[0].startswith(("//", "/*")):
            end = match.end()
        if not match[0].startswith('"'):
            continue
        if not joined:
            line = text.count("\n", 0, match.start()) + 1
        joined += match[0][1:-1]
        end = match.end()
    if joined:
        yield joined, line


def problem_of_text(text):
    found = [begin for begin in BEGINNINGS if re.match(rf"{begin}\b", text)]
    return f"'{text[:40]}' begins with '{found[0]}'" if found else None


def problem_of(name):
    """What to write instead; nothing where a name is fine."""
    if name in ALLOWED:
        return None
    found = [part for part in parts(name) if part in WORDS]
    return f"'{name}' says {found[0]}, needs {WORDS[found[0]]}" if found else None


def files(*ends):
    for path in sorted(ROOT.rglob("*")):
        inside = path.relative_to(ROOT)
        if path.suffix in ends and not IGNORED & set(inside.parts) and path.is_file():
            yield inside


def problems_in(path, text):
    names = python_names(text) if path.suffix == ".py" else cpp_names(text)
    return [f"{path}:{line}: {problem}" for name, line in names if (problem := problem_of(name))]


class WordsTest(unittest.TestCase):
    def test_identifiers_have_one_word_for_one_thing(self):
        found = []
        for path in files(".cpp", ".h", ".py"):
            found += problems_in(path, (ROOT / path).read_text(encoding="utf-8"))
        self.assertEqual(found, [])

    def test_files_are_named_with_the_same_words(self):
        found = [f"{path}: {problem}" for path in files(".cpp", ".h", ".py")
                 if (problem := problem_of(path.stem))]
        self.assertEqual(found, [])

    def test_no_two_headers_have_one_name(self):
        folders = defaultdict(list)
        for path in files(".h"):
            folders[path.name].append(str(path.parent))
        twice = {name: where for name, where in folders.items()
                 if len(where) > 1 and name not in ALLOWED_HEADERS}
        self.assertEqual(twice, {})

    def test_help_texts_say_max_and_min(self):
        found = []
        for path in sorted((ROOT / "cli").glob("*.cpp")):
            for text, line in cpp_texts(path.read_text(encoding="utf-8")):
                if problem := problem_of_text(text):
                    found.append(f"cli/{path.name}:{line}: {problem}")
        self.assertEqual(found, [])

    def test_a_help_text_with_a_wrong_beginning_is_found(self):
        source = 'add("--rows", rows,\n    "Most "  // of all\n    "rows");\nadd("--a", a, "At most 3", "Mostly");'
        self.assertEqual(list(cpp_texts(source)),
                         [("--rows", 1), ("Most rows", 2), ("--a", 4), ("At most 3", 4), ("Mostly", 4)])
        self.assertEqual(list(cpp_texts('f("So many " \n "rows", R"(Most)");')), [("So many rows", 1)])
        for text in ("Most rows", "Least PSNR", "So many rows", "So much time"):
            self.assertIsNotNone(problem_of_text(text), text)
        for text in ("Mostly", "Max rows", "At most 3", "Some", "Soon"):
            self.assertIsNone(problem_of_text(text), text)

    def test_what_is_allowed_is_there(self):
        text = "\n".join((ROOT / path).read_text(encoding="utf-8") for path in files(".cpp", ".py"))
        for name in ALLOWED:
            self.assertRegex(text, rf"\b{name}\b")
        headers = [path.name for path in files(".h")]
        for name in ALLOWED_HEADERS:
            self.assertGreater(headers.count(name), 1)

    def test_a_wrong_word_is_found(self):
        source = 'int kMostRows = 1;  // most_rows\nTEST(A, TakesThreeAtMost) { f("most_rows", 1\'000); }\n'
        self.assertEqual(problems_in(Path("a.h"), source), ["a.h:1: 'kMostRows' says most, needs max"])
        for name in ("most", "least_bytes_", "MOST_ROWS", "EntityForecaster", "kLeast", "copy_foresight"):
            self.assertIsNotNone(problem_of(name), name)

    def test_words_that_only_contain_such_a_word_are_fine(self):
        for name in ("outermost", "almost", "Foremost", "kAlmostOne", "most_confident", "LatentsWithoutLooking"):
            self.assertIsNone(problem_of(name), name)

    def test_python_is_read_too(self):
        self.assertEqual(problems_in(Path("a.py"), '"""most"""\nleast = 1  # least\n'),
                         ["a.py:2: 'least' says least, needs min"])


if __name__ == "__main__":
    unittest.main()
