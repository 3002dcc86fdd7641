# SPDX-License-Identifier: Apache-2.0
"""Whether values are of their types."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from engram.idf import types
from engram.idf.quantity import is_within
from engram.idf.types import Type
from engram.idf.value import describe, element_name, join_path, kind_name, number_text

UNIT_TOLERANCE = 1e-3
"""How far the norm of an orientation may be from 1."""

LEAF_KINDS = {
    "Int": "int32",
    "IntEnum": "int32",
    "Long": "int64",
    "Time": "int64",
    "Float": "float32",
    "Double": "float64",
    "String": "string",
    "MemoryLink": "string",
    "Bool": "bool",
}
"""The kind of value of each type that is neither array nor container."""


@dataclass(frozen=True)
class Mismatch:
    """One place where a value is not of its type; an empty path is the value itself."""

    path: str
    found: str
    needed: str

    def __str__(self) -> str:
        return f"'{self.path}': found {self.found}, needs {self.needed}"


def check(value: object, of: Type) -> list[Mismatch]:
    """Everything in `value` that is not as the type says; empty: it fits.

    An array is reported once. Members may stand in any order; an optional one that is absent is
    there as None.
    """
    return list(_walk(value, of, ""))


def check_leaf(value: Any, of: Type, path: str = "") -> Mismatch | None:
    """What is wrong with a value of a type without parts."""
    array = types.as_array(of)
    if array is not None:
        return _check_array(value, array, of, path)
    if kind_name(value) != LEAF_KINDS[of.kind]:
        return Mismatch(path, describe(value), types.describe(of))
    if isinstance(of, types.IntEnum) and all(known.value != value for known in of.values):
        return Mismatch(path, describe(value), types.describe(of))
    if isinstance(of, types.Quantity) and not is_within(of, np.asarray(value)):
        return Mismatch(path, describe(value), bounds_text(of))
    return None


def is_array(value: Any, needed: types.ArrayType) -> bool:
    """True where `value` is an ndarray of the element type, and a shape that is admitted."""
    return (
        isinstance(value, np.ndarray)
        and element_name(value) == needed.element
        and needed.admits(value.shape)
    )


def bounds_text(of: types.Quantity) -> str:
    """ "0..1", "..5"."""
    low, high = ("" if one is None else number_text(one) for one in (of.minimum, of.maximum))
    return f"{low}..{high}"


def _check_array(value: Any, needed: types.ArrayType, of: Type, path: str) -> Mismatch | None:
    if not is_array(value, needed):
        return Mismatch(path, describe(value), types.describe(of))
    if isinstance(of, types.Quantity):
        return _check_elements(value, of, path)
    if isinstance(of, types.Orientation):
        norm = float(np.linalg.norm(value.astype(np.float64)))
        if not abs(norm - 1) <= UNIT_TOLERANCE:
            return Mismatch(path, f"a quaternion of norm {number_text(norm)}", "norm 1")
    return None


def _check_elements(array: npt.NDArray[Any], of: types.Quantity, path: str) -> Mismatch | None:
    """The first element that is out of bounds, and how many are."""
    outside = np.flatnonzero(~is_within(of, array))
    if outside.size == 0:
        return None
    first = array.reshape(-1)[outside[0]]
    found = f"{outside.size} of {array.size} elements out of bounds, first element {outside[0]} = "
    return Mismatch(path, found + number_text(first), bounds_text(of))


def _walk(value: Any, of: Type, path: str) -> Iterator[Mismatch]:
    if of.optional and value is None:
        return
    if isinstance(of, (types.Object, types.Pose)):
        yield from _walk_members(value, of, path)
    elif isinstance(of, types.Dict):
        yield from _walk_dict(value, of, path)
    elif isinstance(of, (types.List, types.Tuple, types.Pair)):
        yield from _walk_list(value, of, path)
    else:
        wrong = check_leaf(value, of, path)
        if wrong is not None:
            yield wrong


def _walk_dict(value: Any, of: types.Dict, path: str) -> Iterator[Mismatch]:
    if not isinstance(value, dict):
        yield Mismatch(path, describe(value), types.describe(of))
        return
    for key, part in value.items():
        yield from _walk(part, of.element, join_path(path, key))


def _walk_list(value: Any, of: Type, path: str) -> Iterator[Mismatch]:
    inner = [part.type for part in types.parts(of)]
    is_list = isinstance(value, (list, tuple))
    size = len(inner)
    if isinstance(of, types.List):
        size = len(value) if is_list and of.size == types.FREE_SIZE else of.size
        inner = inner * len(value) if is_list else []
    if not is_list or len(value) != size:
        yield Mismatch(path, describe(value), types.describe(of))
    for index, (part, part_type) in enumerate(zip(value if is_list else (), inner)):
        yield from _walk(part, part_type, join_path(path, index))


def _walk_members(value: Any, of: Type, path: str) -> Iterator[Mismatch]:
    if not isinstance(value, dict):
        yield Mismatch(path, describe(value), types.describe(of))
        return
    members = types.parts(of)
    for member in members:
        inner = join_path(path, member.name)
        if member.name in value:
            yield from _walk(value[member.name], member.type, inner)
        else:
            yield Mismatch(inner, "nothing", types.describe(member.type))
    names = {member.name for member in members}
    for key in value:
        if key not in names:
            needed = f"no such member in {types.describe(of)}"
            yield Mismatch(join_path(path, key), describe(value[key]), needed)
