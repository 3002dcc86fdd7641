# SPDX-License-Identifier: Apache-2.0
"""What the classes of `engram idf generate --python` stand on: their values and back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar, Self

import numpy as np

from engram.idf import types
from engram.idf.cast import cast, convert
from engram.idf.check import LEAF_KINDS, is_array
from engram.idf.errors import IdfError
from engram.idf.pose import Pose
from engram.idf.types import Type
from engram.idf.value import Value, describe, equal, join_path, kind_name, normal_array


class TypedObject:
    """Base of generated classes: an object of one type, with an attribute for each member."""

    _idf_attributes: ClassVar[Mapping[str, str]] = {}
    """The attributes of those members whose key cannot be one."""

    @staticmethod
    def idf_type() -> types.Object:
        """The type of its values."""
        raise NotImplementedError

    def to_idf(self) -> dict[str, Value]:
        """The value of this object, each number in the kind that the type says.

        Arrays that are row-major and of the element type are not copied. Bounds are not checked:
        engram.idf.check does.
        Raises IdfError naming the first member that cannot be a value of its type.
        """
        made: dict[str, Value] = to_value(self, self.idf_type())
        return made

    @classmethod
    def from_idf(cls, value: object) -> Self:
        """Reads a value; its arrays are not copied, and read-only where they come from bytes.

        Members that the type does not have are ignored, so that a core type reads what a provider
        extended. Where the value does not fit as it is, numbers are widened as far as nothing is
        lost. Bounds are not checked: engram.idf.check does.
        Raises IdfError listing everything that does not fit, each with its path.
        """
        made: Self = from_value(value, replace(cls.idf_type(), python=cls))
        return made

    def __eq__(self, other: object) -> bool:
        """Bit by bit: NaN equals the same NaN."""
        if type(self) is not type(other):
            return NotImplemented
        return equal(self.to_idf(), other.to_idf())  # type: ignore[attr-defined]


class _Misfit(Exception):
    """The value is not as the type says: casting may help."""


def from_value(value: object, of: Type) -> Any:
    """The Python object that a value of the type stands for; see TypedObject.from_idf."""
    try:
        return _build(value, of)
    except _Misfit:
        made, notes = cast(value, of)
    if any(note.kind != "dropped" for note in notes):
        raise IdfError(f"{types.describe(of)}: " + "; ".join(str(note) for note in notes))
    return _build(made, of)


def to_value(given: object, of: Type, path: str = "") -> Any:
    """The value of the type that a Python object stands for; see TypedObject.to_idf."""
    if of.optional and given is None:
        return None
    array = types.as_array(of)
    if array is not None:
        return _write_array(given, array, of, path)
    writer = _WRITERS.get(of.kind, _write_leaf)
    return writer(given, of, path)


def _build(value: Any, of: Type) -> Any:
    if of.optional and value is None:
        return None
    array = types.as_array(of)
    if array is not None:
        return normal_array(value) if is_array(value, array) else _misfit()
    builder = _BUILDERS.get(of.kind)
    if builder is not None:
        return builder(value, of)
    if kind_name(value) != LEAF_KINDS[of.kind]:
        _misfit()
    return value if isinstance(value, str) else value.item() if hasattr(value, "item") else value


def _misfit() -> Any:
    raise _Misfit


def _build_enum(value: Any, of: types.IntEnum) -> Any:
    if kind_name(value) != "int32" or all(known.value != value for known in of.values):
        _misfit()
    return int(value) if of.python is None else of.python(int(value))


def _build_list(value: Any, of: types.List) -> Any:
    if not isinstance(value, (list, tuple)) or of.size not in (types.FREE_SIZE, len(value)):
        _misfit()
    return [_build(part, of.element) for part in value]


def _build_tuple(value: Any, of: Type) -> Any:
    inner = types.parts(of)
    if not isinstance(value, (list, tuple)) or len(value) != len(inner):
        _misfit()
    return tuple(_build(part, member.type) for part, member in zip(value, inner))


def _build_dict(value: Any, of: types.Dict) -> Any:
    if not isinstance(value, dict):
        _misfit()
    return {key: _build(part, of.element) for key, part in value.items()}


def _build_members(value: Any, of: Type) -> dict[str, Any]:
    made = {}
    for member in types.parts(of):
        if not isinstance(value, dict) or member.name not in value:
            _misfit()
        made[member.name] = _build(value[member.name], member.type)
    return made


def _build_object(value: Any, of: types.Object) -> Any:
    if not isinstance(value, dict):
        _misfit()
    members = _build_members(value, of)
    if of.python is None:
        return members
    renamed = of.python._idf_attributes
    return of.python(**{renamed.get(key, key): part for key, part in members.items()})


def _build_pose(value: Any, of: types.Pose) -> Pose:
    # Not the norm: that is a bound.
    members = _build_members(value, of)
    return Pose(members["position"], members["orientation"])


_BUILDERS: dict[str, Any] = {
    "IntEnum": _build_enum,
    "List": _build_list,
    "Tuple": _build_tuple,
    "Pair": _build_tuple,
    "Dict": _build_dict,
    "Object": _build_object,
    "Pose": _build_pose,
}


def _unfit(given: object, of: Type, path: str) -> IdfError:
    try:
        found = describe(given)
    except IdfError:
        found = type(given).__name__
    return IdfError(f"'{path}': found {found}, needs {types.describe(of)}")


_NUMBERS: dict[str, Any] = {
    "int32": np.int32,
    "int64": np.int64,
    "float32": np.float32,
    "float64": np.float64,
}
_INT_ENDS = {"int32": 2**31, "int64": 2**63}
_FLOAT32_MAX = float(np.finfo(np.float32).max)


def _write_leaf(given: Any, of: Type, path: str) -> Any:
    kind = LEAF_KINDS[of.kind]
    if kind in ("string", "bool"):
        needed = str if kind == "string" else (bool, np.bool_)
        if not isinstance(given, needed):  # type: ignore[arg-type]
            raise _unfit(given, of, path)
        return given if kind == "string" else bool(given)
    # What most numbers are, without the detour by way of an array.
    if type(given) is int and kind[0] == "i" and abs(given) < _INT_ENDS[kind]:
        return _NUMBERS[kind](given)
    if type(given) is float and kind[0] == "f" and abs(given) <= _FLOAT32_MAX:
        return _NUMBERS[kind](given)
    if not isinstance(given, (int, float, np.integer, np.floating)) or isinstance(given, bool):
        raise _unfit(given, of, path)
    try:
        taken = convert(np.asarray(given), np.dtype(kind))
    except (OverflowError, ValueError, TypeError):
        taken = None
    if taken is None:
        raise _unfit(given, of, path)
    # A scalar of the very same type stays: even the bits of its NaN.
    return _NUMBERS[kind](taken[0][()])


def _write_array(given: Any, needed: types.ArrayType, of: Type, path: str) -> Any:
    try:
        array = normal_array(np.asarray(given))
    except (IdfError, ValueError):
        raise _unfit(given, of, path) from None
    taken = convert(array, np.dtype(needed.element)) if needed.admits(array.shape) else None
    if taken is None:
        raise _unfit(array, of, path)
    return taken[0]


def _write_list(given: Any, of: types.List, path: str) -> Any:
    if not isinstance(given, (list, tuple)) or of.size not in (types.FREE_SIZE, len(given)):
        raise _unfit(given, of, path)
    return [to_value(part, of.element, join_path(path, i)) for i, part in enumerate(given)]


def _write_tuple(given: Any, of: Type, path: str) -> Any:
    inner = types.parts(of)
    if not isinstance(given, (list, tuple)) or len(given) != len(inner):
        raise _unfit(given, of, path)
    return [
        to_value(part, member.type, join_path(path, member.name))
        for part, member in zip(given, inner)
    ]


def _write_dict(given: Any, of: types.Dict, path: str) -> Any:
    if not isinstance(given, dict) or not all(isinstance(key, str) for key in given):
        raise _unfit(given, of, path)
    return {key: to_value(part, of.element, join_path(path, key)) for key, part in given.items()}


def _write_object(given: Any, of: types.Object, path: str) -> Any:
    """Of a class derived from the one needed, what the type has."""
    renamed: Mapping[str, str] = {}
    if of.python is not None:
        if not isinstance(given, of.python):
            raise _unfit(given, of, path)
        renamed = of.python._idf_attributes
    elif not isinstance(given, dict):
        raise _unfit(given, of, path)
    made = {}
    for member in types.parts(of):
        place = join_path(path, member.name)
        if isinstance(given, dict):
            part = given.get(member.name)
        else:
            part = getattr(given, renamed.get(member.name, member.name))
        made[member.name] = to_value(part, member.type, place)
    return made


def _write_pose(given: Any, of: types.Pose, path: str) -> Any:
    if not isinstance(given, Pose):
        raise _unfit(given, of, path)
    return {
        part.name: to_value(getattr(given, part.name), part.type, join_path(path, part.name))
        for part in types.parts(of)
    }


_WRITERS: dict[str, Any] = {
    "List": _write_list,
    "Tuple": _write_tuple,
    "Pair": _write_tuple,
    "Dict": _write_dict,
    "Object": _write_object,
    "Pose": _write_pose,
}
