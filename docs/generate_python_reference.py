#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Writes docs/reference/python.md from signatures and docstrings of python/engram; runs none of it.

generate_python_reference.py [--check]
"""

from __future__ import annotations

import ast
import difflib
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
REFERENCE = ROOT / "docs" / "reference" / "python.md"

#: Modules that programs import, in the order of the page.
MODULES = ("engram", "engram.errors", "engram.torch", "engram.idf", "engram.idf.types")

_INTRODUCTION = """\
# Python package

Signatures and docstrings of `python/engram`. `make reference` writes this page; a test compares it
with the sources.

"""

_OPERATORS = ("__len__", "__getitem__", "__contains__", "__iter__", "__call__", "__array__")

Definition = ast.ClassDef | ast.FunctionDef


def file_of(module: str, root: pathlib.Path) -> pathlib.Path:
    base = root / "python" / pathlib.Path(*module.split("."))
    return base / "__init__.py" if base.is_dir() else base.with_suffix(".py")


class Sources:
    """Modules of the package, parsed once each."""

    def __init__(self, root: pathlib.Path) -> None:
        self._root = root
        self._read: dict[str, tuple[ast.Module, list[str]]] = {}

    def of(self, module: str) -> tuple[ast.Module, list[str]]:
        if module not in self._read:
            text = file_of(module, self._root).read_text()
            self._read[module] = ast.parse(text), text.split("\n")
        return self._read[module]

    def public_names(self, module: str) -> list[str]:
        tree, _ = self.of(module)
        for node in tree.body:
            if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
                if not isinstance(node.value, (ast.List, ast.Tuple)):
                    break
                return [str(ast.literal_eval(one)) for one in node.value.elts]
        return [node.name for node in tree.body
                if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and node.name[0] != "_"]

    def find(self, module: str, name: str) -> tuple[Definition, list[str]] | None:
        """The definition of a name, wherever the module imports it from, and that file's lines."""
        tree, lines = self.of(module)
        for node in tree.body:
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and node.name == name:
                return node, lines
        for one in ast.walk(tree):
            if isinstance(one, ast.ImportFrom) and one.module and one.level == 0:
                for alias in one.names:
                    is_named = (alias.asname or alias.name) == name
                    if is_named and one.module.startswith("engram") and one.module != module:
                        return self.find(one.module, alias.name)
        return None


def reference_of(root: pathlib.Path) -> str:
    sources = Sources(root)
    parts = [_INTRODUCTION]
    for module in MODULES:
        if not file_of(module, root).exists():
            continue
        parts.append(f"## {module}\n\n{_prose(docstring(sources.of(module)[0]))}")
        for name in sources.public_names(module):
            if found := sources.find(module, name):
                parts.append(_entry(name, *found))
    return re.sub(r"\n{3,}", "\n\n", "\n".join(parts)).rstrip() + "\n"


def docstring(node: ast.Module | Definition) -> str:
    """As it stands there, less the indentation of its place: examples keep theirs."""
    text = ast.get_docstring(node, clean=False) or ""
    indent = 0 if isinstance(node, ast.Module) else node.body[0].col_offset
    first, *rest = text.split("\n")
    return "\n".join([first.lstrip(), *(line[indent:].rstrip() for line in rest)]).rstrip()


def _entry(name: str, node: Definition, lines: list[str]) -> str:
    if isinstance(node, ast.FunctionDef):
        return f"### {name}\n\n```python\n{_signature(node)}\n```\n\n{_prose(docstring(node))}"
    bases = ", ".join(ast.unparse(base) for base in node.bases)
    text = f"### class {name}{f'({bases})' if bases else ''}\n\n{_prose(docstring(node))}"
    members = [one for child in node.body if (one := _member(child, lines))]
    return text + "".join(f"* {one}\n" for one in members)


def _member(node: ast.stmt, lines: list[str]) -> str:
    if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
        if node.target.id.startswith("_"):
            return ""
        title = f"{node.target.id}: {ast.unparse(node.annotation)}"
        return _item(title, _comment_of(node.lineno - 1, lines))
    if not isinstance(node, ast.FunctionDef):
        return ""
    decorators = {ast.unparse(one).split("(")[0] for one in node.decorator_list}
    about = docstring(node)
    if decorators & {"property", "cached_property", "functools.cached_property"}:
        result = f": {ast.unparse(node.returns)}" if node.returns else ""
        return "" if node.name.startswith("_") else _item(node.name + result, about)
    if node.name == "__init__":
        return _item(_signature(node).replace("__init__", "", 1).removesuffix(" -> None"), about)
    is_shown_operator = node.name in _OPERATORS and about
    if node.name.startswith("_") and not is_shown_operator:
        return ""
    return _item(_signature(node), about)


def _comment_of(at: int, lines: list[str]) -> str:
    """What `#:` says of a member: behind it, or on the lines above."""
    _, _, comment = lines[at].partition("#: ")
    while lines[at - 1].strip().startswith("#: "):
        at -= 1
        comment = lines[at].strip().removeprefix("#: ") + " " + comment
    return comment


def _signature(node: ast.FunctionDef) -> str:
    arguments = ast.unparse(node.args).replace("=", " = ")
    arguments = re.sub(r"^self(, )?", "", arguments)
    result = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    return f"{node.name}({arguments}){result}"


def _item(title: str, about: str) -> str:
    paragraphs = about.strip().split("\n\n")
    text = "\n\n".join(" ".join(one.split()) for one in paragraphs if one.strip())
    return f"`{title}`" + (f": {text}".replace("\n\n", "\n\n  ") if text else "")


def _prose(text: str | None) -> str:
    """A docstring as Markdown; what it indents by four is an example in Python."""
    blocks = []
    for paragraph in re.split(r"\n\n(?! {4})", text or ""):
        example = re.search(r"(?:^|\n\n)( {4}.*)", paragraph, re.DOTALL)
        if not example:
            blocks.append(paragraph)
            continue
        if prose := paragraph[: example.start()].strip():
            blocks.append(prose)
        code = "\n".join(line[4:] for line in example[1].rstrip().split("\n"))
        blocks.append(f"```python\n{code}\n```")
    return "\n\n".join(blocks).strip() + "\n\n"


def main() -> int:
    text = reference_of(ROOT)
    if "--check" not in sys.argv[1:]:
        REFERENCE.parent.mkdir(exist_ok=True)
        REFERENCE.write_text(text)
        return 0
    old = REFERENCE.read_text() if REFERENCE.exists() else ""
    sys.stdout.writelines(difflib.unified_diff(old.splitlines(True), text.splitlines(True),
                                               "docs/reference/python.md", "the sources"))
    return 0 if text == old else 1


if __name__ == "__main__":
    sys.exit(main())
