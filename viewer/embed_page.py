#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the files of the built page as a table in C++: names, types, gzipped bytes and ETags.

embed_page.py FOLDER OUTPUT
"""

from __future__ import annotations

import gzip
import hashlib
import pathlib
import struct
import sys

TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".mjs": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".json": "application/json",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".ico": "image/x-icon",
    ".woff2": "font/woff2",
    ".wasm": "application/wasm",
    ".txt": "text/plain; charset=utf-8",
}

_HEAD = """\
// SPDX-License-Identifier: Apache-2.0
// Made by viewer/embed_page.py.
#include "viewer/page_assets.h"

namespace engram::viewer {

namespace {

"""


class EmbedError(Exception):
    """What is wrong with the folder."""


def files_of(folder: pathlib.Path) -> list[tuple[str, pathlib.Path]]:
    """The path in a URL and the file, of each file that browsers need."""
    found = [("/" + path.relative_to(folder).as_posix(), path)
             for path in sorted(folder.rglob("*")) if path.is_file() and path.suffix != ".map"]
    if "/index.html" not in dict(found):
        raise EmbedError(f"'{folder}': has no index.html, needs what 'npm run build' makes")
    for url, path in found:
        if path.suffix not in TYPES:
            raise EmbedError(f"'{path}': has no known type, needs one of {', '.join(TYPES)}")
        if not url.isascii() or '"' in url or "\\" in url:
            raise EmbedError(f"'{path}': needs a name of plain letters")
    return found


def words_of(data: bytes) -> str:
    """The bytes as 64-bit numbers: a compiler reads these eight times as fast as bytes."""
    padded = data + bytes(-len(data) % 8)
    numbers = [f"{number:#x}ULL" for number in struct.unpack(f"<{len(padded) // 8}Q", padded)]
    return ",\n".join(", ".join(numbers[i:i + 8]) for i in range(0, len(numbers), 8))


def table_of(folder: pathlib.Path) -> str:
    text = _HEAD
    rows = []
    for number, (url, path) in enumerate(files_of(folder)):
        plain = path.read_bytes()
        # Without a time, so that equal pages are equal programs.
        zipped = gzip.compress(plain, 9, mtime=0)
        etag = hashlib.sha256(plain).hexdigest()[:16]
        text += f"constexpr uint64_t kAsset{number}[] = {{\n{words_of(zipped)}}};\n\n"
        place = "/" if url == "/index.html" else url
        immutable = "true" if url.startswith("/assets/") else "false"
        rows.append(f'    {{"{place}", "{TYPES[path.suffix]}", "\\"{etag}\\"",\n'
                    f"     std::as_bytes(std::span(kAsset{number})).first({len(zipped)}), "
                    f"{immutable}}},\n")
    return (text + "const PageAsset kAssets[] = {\n" + "".join(rows) + "};\n\n}  // namespace\n\n"
            "std::span<const PageAsset> page_assets() {\n  return kAssets;\n}\n\n"
            "}  // namespace engram::viewer\n")


def main() -> int:
    folder, output = map(pathlib.Path, sys.argv[1:])
    try:
        text = table_of(folder)
    except EmbedError as error:
        print(f"embed_page.py: {error}", file=sys.stderr)
        return 1
    if not output.exists() or output.read_text() != text:
        output.write_text(text)
    else:
        output.touch()
    return 0


if __name__ == "__main__":
    sys.exit(main())
