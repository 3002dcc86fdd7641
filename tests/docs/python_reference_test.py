# SPDX-License-Identifier: Apache-2.0
"""docs/reference/python.md is what the sources of the Python package say now."""

from __future__ import annotations

import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs"))

import generate_python_reference as generator  # noqa: E402

_MODULE = '''"""About it.

    import engram

More.
"""
__all__ = ["Thing", "make"]
from engram.parts import make

class Thing:
    """A thing."""
    size: int  #: In m.
    _hidden: int
    def __init__(self, size: int = 1) -> None: ...
    @property
    def height(self) -> float:
        """How high."""
    def grow(self, by: float) -> None: ...
    def _shrink(self) -> None: ...
'''


class PythonReference(unittest.TestCase):
    def test_is_what_the_sources_say(self) -> None:
        is_current = generator.REFERENCE.read_text() == generator.reference_of(ROOT)
        self.assertTrue(is_current, "is out of date: run docs/generate_python_reference.py")

    def test_tells_all_that_is_public_and_nothing_else(self) -> None:
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch, "python", "engram")
            folder.mkdir(parents=True)
            (folder / "__init__.py").write_text(_MODULE)
            (folder / "parts.py").write_text('def make() -> int:\n    """Makes."""\n')
            text = generator.reference_of(pathlib.Path(scratch))
        for part in ("```python\nimport engram\n```", "### class Thing", "* `size: int`: In m.",
                     "* `(size: int = 1)`", "* `height: float`: How high.",
                     "* `grow(by: float) -> None`", "### make", "make() -> int"):
            self.assertIn(part, text)
        self.assertNotIn("hidden", text)
        self.assertNotIn("shrink", text)

    def test_names_every_public_name(self) -> None:
        text = generator.REFERENCE.read_text()
        sources = generator.Sources(ROOT)
        for name in sources.public_names("engram"):
            self.assertTrue(re.search(rf"(?m)^### (class )?{name}\b", text), name)


if __name__ == "__main__":
    unittest.main()
