# SPDX-License-Identifier: Apache-2.0
"""What a value of the Interpretable Data Format is in Python.

| kind | Python |
|---|---|
| none | None |
| bool | bool (np.bool_ is taken as well) |
| int32, int64, float32, float64 | np.int32, np.int64, np.float32, np.float64 |
| string | str; bytes that are no UTF-8 come as surrogate escapes |
| ndarray | np.ndarray of int8 ... uint64, float32, float64 |
| list | list (tuples are taken as well) |
| dict | dict with str keys, in the order of insertion |

A plain int is taken as int64, a plain float as float64.
"""

from __future__ import annotations

from typing import Any, TypeAlias, Union

import numpy as np
import numpy.typing as npt

from engram.idf.errors import IdfError

Value: TypeAlias = Union[
    None,
    bool,
    np.int32,
    np.int64,
    np.float32,
    np.float64,
    str,
    npt.NDArray[Any],
    list["Value"],
    dict[str, "Value"],
]

# Names by the codes of the binary form, which start at 1: never reorder.
ELEMENT_NAMES = (
    "int8",
    "int16",
    "int32",
    "int64",
    "uint8",
    "uint16",
    "uint32",
    "uint64",
    "float32",
    "float64",
)

_SHOWN_TEXT = 40


def kind_name(value: object) -> str:
    """ "none", "bool", "int32", "string", "ndarray", "list", ...

    Raises IdfError where `value` is of no kind.
    """
    if value is None:
        return "none"
    if isinstance(value, (bool, np.bool_)):
        return "bool"
    if isinstance(value, np.generic) and value.dtype.kind in "if" and value.itemsize in (4, 8):
        return f"{'int' if value.dtype.kind == 'i' else 'float'}{8 * value.itemsize}"
    for python_type, name in _KINDS:
        if isinstance(value, python_type):
            return name
    raise IdfError(f"a value of Python type {type(value).__name__} is of no IDF kind")


_KINDS: tuple[tuple[type | tuple[type, ...], str], ...] = (
    (int, "int64"),
    (float, "float64"),
    (str, "string"),
    (np.ndarray, "ndarray"),
    ((list, tuple), "list"),
    (dict, "dict"),
)


def element_name(array: npt.NDArray[Any]) -> str:
    """ "uint8", "float32", ... Raises IdfError where an ndarray has no such elements."""
    name = array.dtype.newbyteorder("=").name
    if array.dtype.kind not in "iuf" or name not in ELEMENT_NAMES:
        raise IdfError(f"an ndarray has elements of {array.dtype}, needs one of {ELEMENT_NAMES}")
    return name


def normal_array(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The same elements row-major and little-endian; the same array where it is so already."""
    dtype = np.dtype(element_name(array)).newbyteorder("<")
    return np.asarray(array, dtype=dtype, order="C")


def describe(value: object) -> str:
    """ "int32 5", "ndarray float32 [3]", "list of 2", "none": a value in a few words."""
    kind = kind_name(value)
    if isinstance(value, str):
        return f"string '{_shortened(value)}'"
    if isinstance(value, np.ndarray):
        return f"ndarray {element_name(value)} {list(value.shape)}"
    if isinstance(value, (list, tuple, dict)):
        return f"{kind} of {len(value)}"
    if kind == "bool":
        return "bool true" if value else "bool false"
    return kind if value is None else f"{kind} {number_text(value)}"


def number_text(number: Any) -> str:
    """The shortest digits of a number, without ".0"."""
    text = str(number)
    return text[:-2] if text.endswith(".0") else text


def _shortened(text: str) -> str:
    """The beginning of a long text, cut between characters."""
    data = text.encode("utf-8", "surrogatepass")
    if len(data) <= _SHOWN_TEXT:
        return text
    end = _SHOWN_TEXT
    while end > 0 and data[end] & 0xC0 == 0x80:
        end -= 1
    return data[:end].decode("utf-8", "surrogatepass") + "..."


def equal(a: object, b: object) -> bool:
    """True where both are the same bit by bit: kinds, the order of keys, the bits of NaNs."""
    kind = kind_name(a)
    if kind != kind_name(b):
        return False
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return _equal_arrays(a, b)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(map(equal, a, b))
    if isinstance(a, dict) and isinstance(b, dict):
        return list(a) == list(b) and all(map(equal, a.values(), b.values()))
    if kind.startswith("float"):
        return _bits(a, kind) == _bits(b, kind)
    return bool(a == b)


def _bits(number: object, kind: str) -> bytes:
    # Of an array: a NaN that goes through a Python float may change.
    return np.asarray(number, kind).tobytes()


def _equal_arrays(a: npt.NDArray[Any], b: npt.NDArray[Any]) -> bool:
    if element_name(a) != element_name(b) or a.shape != b.shape:
        return False
    bits = f"<u{a.dtype.itemsize}"
    return bool(np.array_equal(normal_array(a).view(bits), normal_array(b).view(bits)))


def at(value: object, path: str) -> Value:
    """The value at a path of dict keys and list indices; the empty path is the value itself.

    A `/` inside a key is written `\\/`, a backslash `\\\\`, an empty key `\\e`.
    Raises IdfError naming the part of the path that is not there.
    """
    current: Any = value
    walked = ""
    for name in split_path(path) if path else []:
        walked = join_path(walked, name)
        try:
            current = _part(current, name)
        except (KeyError, IndexError):
            raise IdfError(f"'{walked}' of path '{path}': found nothing") from None
    return current  # type: ignore[no-any-return]


def _part(value: Any, name: str) -> Any:
    if isinstance(value, dict):
        return value[name]
    if isinstance(value, (list, tuple)) and name.isascii() and name.isdigit() and len(name) < 20:
        return value[int(name)]
    raise KeyError(name)


def split_path(path: str) -> list[str]:
    """Splits "a\\/b/c" into ["a/b", "c"]."""
    names = [""]
    letters = iter(path)
    for letter in letters:
        if letter == "\\":
            escaped = next(letters, letter)
            names[-1] += "" if escaped == "e" else escaped
        elif letter == "/":
            names.append("")
        else:
            names[-1] += letter
    return names


def join_path(path: str, name: str | int) -> str:
    """Appends `name` to `path`, escaped so that split_path gives it back."""
    escaped = str(name).replace("\\", "\\\\").replace("/", "\\/") or "\\e"
    return f"{path}/{escaped}" if path else escaped
