# SPDX-License-Identifier: Apache-2.0
"""Takes from a value what fits a type. Source: docs/idf.md, "Casting"."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from engram.idf import types
from engram.idf.check import LEAF_KINDS, Mismatch, check_leaf
from engram.idf.quantity import closest_to_zero
from engram.idf.types import Type
from engram.idf.value import Value, describe, join_path, kind_name, normal_array


@dataclass(frozen=True)
class CastNote:
    """Something that a cast could not keep: "mismatch", "missing", "dropped" or "narrowed"."""

    kind: str
    what: Mismatch

    def __str__(self) -> str:
        return f"{self.kind}: {self.what}"


def cast(value: object, of: Type) -> tuple[Value, list[CastNote]]:
    """A value of the type, and what was not kept; no note: nothing was lost.

    Numbers go over silently where the type holds them exactly. A float that must be rounded is
    rounded and noted; an integer that is out of range, or would get a fraction cut off, is no
    match. What is no match or missing becomes the default.
    """
    caster = _Caster()
    return caster.cast(value, of, ""), caster.notes


def default_value(of: Type) -> Any:
    """The value where nothing is known: zeros (or what is closest within the bounds), empty texts,
    lists and free axes, the first value of an enum, the identity rotation, None for all that is
    optional."""
    if of.optional:
        return None
    if isinstance(of, (types.Quaternion, types.Orientation)):
        return np.array([1, 0, 0, 0], of.element)
    array = types.as_array(of)
    if array is not None:
        fill = closest_to_zero(of, np.dtype(array.element)) if isinstance(of, types.Quantity) else 0
        return np.full([max(size, 0) for size in array.shape], fill, array.element)
    if isinstance(of, types.IntEnum):
        return np.int32(of.values[0].value)
    if isinstance(of, types.Dict):
        return {}
    if isinstance(of, types.List):
        return [default_value(of.element) for _ in range(max(of.size, 0))]
    if isinstance(of, (types.Tuple, types.Pair)):
        return [default_value(part.type) for part in types.parts(of)]
    if isinstance(of, (types.Object, types.Pose)):
        return {part.name: default_value(part.type) for part in types.parts(of)}
    return _default_leaf(of)


def _default_leaf(of: Type) -> Any:
    kind = LEAF_KINDS[of.kind]
    if kind == "string":
        return ""
    if kind == "bool":
        return False
    return closest_to_zero(of, np.dtype(kind)) if isinstance(of, types.Quantity) else np.int64(0)


def convert(
    numbers: npt.NDArray[Any], dtype: np.dtype[Any]
) -> tuple[npt.NDArray[Any], bool] | None:
    """The numbers as `dtype`, and whether all of them are exactly the same; None where one of them
    has no place there (out of range, a fraction for an integer)."""
    if numbers.dtype == dtype:
        return numbers, True
    if numbers.dtype.kind == "f":
        return _from_floats(numbers, dtype)
    if dtype.kind != "f":
        limits = np.iinfo(dtype)
        extremes = (int(numbers.min()), int(numbers.max())) if numbers.size else (0, 0)
        fits = limits.min <= extremes[0] and extremes[1] <= limits.max
        return (numbers.astype(dtype), True) if fits else None
    made = numbers.astype(dtype)
    end = math.ldexp(1.0, np.iinfo(numbers.dtype).bits - (numbers.dtype.kind == "i"))
    if np.any(made >= end):
        return made, False
    return made, bool(np.all(made.astype(numbers.dtype) == numbers))


def _from_floats(
    numbers: npt.NDArray[Any], dtype: np.dtype[Any]
) -> tuple[npt.NDArray[Any], bool] | None:
    if dtype.kind == "f":
        finite = np.isfinite(numbers)
        if np.any(finite & (np.abs(numbers) > np.finfo(dtype).max)):
            return None
        with np.errstate(over="ignore", under="ignore", invalid="ignore"):
            made = numbers.astype(dtype)
        return made, bool(np.all(~finite | (made.astype(numbers.dtype) == numbers)))
    limits = np.iinfo(dtype)
    end = math.ldexp(1.0, limits.bits - (dtype.kind == "i"))
    fits = (numbers >= float(limits.min)) & (numbers < end) & (np.trunc(numbers) == numbers)
    return (numbers.astype(dtype), True) if np.all(fits) else None


def _take_leaf(value: Any, of: Type) -> tuple[Any, bool] | None:
    """A leaf value in the kind of its type; None where it cannot be."""
    array = types.as_array(of)
    if array is not None:
        if not isinstance(value, np.ndarray) or not array.admits(value.shape):
            return None
        return convert(normal_array(value), np.dtype(array.element))
    kind, found = LEAF_KINDS[of.kind], kind_name(value)
    if kind == found or kind in ("string", "bool"):
        return value, True
    if not found.startswith(("int", "float")):
        return None
    taken = convert(np.asarray(value, found), np.dtype(kind))
    return None if taken is None else (np.dtype(kind).type(taken[0]), taken[1])


def _copied(value: Any) -> Any:
    """Containers copied, arrays shared and hence read-only."""
    if isinstance(value, dict):
        return {key: _copied(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_copied(part) for part in value]
    if isinstance(value, np.ndarray):
        value.flags.writeable = False
    return value


class _Caster:
    def __init__(self) -> None:
        self.notes: list[CastNote] = []
        # Made once per type, as a long list of what does not fit could ask for many large arrays.
        # With the types, as only the addresses of what lives are unique.
        self._defaults: dict[int, tuple[Type, Any]] = {}

    def cast(self, value: Any, of: Type, path: str) -> Any:
        if of.optional and value is None:
            return None
        if isinstance(of, (types.Object, types.Pose)):
            return self._members(value, of, path)
        if isinstance(of, types.Dict):
            return self._dict(value, of, path)
        if isinstance(of, (types.List, types.Tuple, types.Pair)):
            return self._list(value, of, path)
        return self._leaf(value, of, path)

    def _note(self, kind: str, path: str, found: str, needed: str) -> None:
        self.notes.append(CastNote(kind, Mismatch(path, found, needed)))

    def _default(self, of: Type) -> Any:
        """The default of a type: containers of its own, arrays shared."""
        if id(of) not in self._defaults:
            self._defaults[id(of)] = (of, default_value(of))
        return _copied(self._defaults[id(of)][1])

    def _mismatch(self, value: Any, of: Type, path: str) -> Any:
        self._note("mismatch", path, describe(value), types.describe(of))
        return self._default(of)

    def _missing(self, of: Type, path: str) -> Any:
        if not of.optional:
            self._note("missing", path, "nothing", types.describe(of))
        return self._default(of)

    def _leaf(self, value: Any, of: Type, path: str) -> Any:
        taken = _take_leaf(value, of)
        if taken is None:
            return self._mismatch(value, of, path)
        # After the conversion: rounding may lead out of the bounds.
        wrong = check_leaf(taken[0], of, path)
        if wrong is not None:
            self.notes.append(CastNote("mismatch", wrong))
            return self._default(of)
        if not taken[1]:
            self._note("narrowed", path, describe(value), types.describe(of))
        return taken[0]

    def _list(self, value: Any, of: Type, path: str) -> Any:
        if not isinstance(value, (list, tuple)):
            return self._mismatch(value, of, path)
        inner = [part.type for part in types.parts(of)]
        if isinstance(of, types.List):
            inner = inner * (len(value) if of.size == types.FREE_SIZE else of.size)
        made = [self._element(value, i, part, join_path(path, i)) for i, part in enumerate(inner)]
        for index in range(len(inner), len(value)):
            place = join_path(path, index)
            self._note("dropped", place, describe(value[index]), types.describe(of))
        return made

    def _element(self, value: Any, index: int, of: Type, path: str) -> Any:
        return self.cast(value[index], of, path) if index < len(value) else self._missing(of, path)

    def _dict(self, value: Any, of: types.Dict, path: str) -> Any:
        if not isinstance(value, dict):
            return self._mismatch(value, of, path)
        return {
            key: self.cast(part, of.element, join_path(path, key)) for key, part in value.items()
        }

    def _members(self, value: Any, of: Type, path: str) -> Any:
        if not isinstance(value, dict):
            return self._mismatch(value, of, path)
        made = {}
        for member in types.parts(of):
            place = join_path(path, member.name)
            if member.name in value:
                made[member.name] = self.cast(value[member.name], member.type, place)
            else:
                made[member.name] = self._missing(member.type, place)
        for key in value:
            if key not in made:
                needed = f"no such member in {types.describe(of)}"
                self._note("dropped", join_path(path, key), describe(value[key]), needed)
        return made
