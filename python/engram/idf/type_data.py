# SPDX-License-Identifier: Apache-2.0
"""Types as values: how segments store them. Source: docs/idf.md, "Types as values"."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from engram.idf import types
from engram.idf.errors import IdfError
from engram.idf.quantity import closest_to_zero
from engram.idf.types import Type
from engram.idf.value import ELEMENT_NAMES, kind_name

_VERSION = 1
_MAX_DEPTH = 64
_MAX_RANK = 16
_MAX_NODES = 2**20
_MAX_TABLE_NODES = 2**22
_MAX_DEFAULT_BYTES = 2**30
_NUMBER_ELEMENTS = {"Int": "int32", "Long": "int64", "Float": "float32", "Double": "float64"}


def type_from_data(value: object) -> Type:
    """Reads a stored type, as `decode` gives it.

    Raises IdfError naming the entry of the table, what was found and what was needed. Safe on
    hostile values: types that nest too deep or whose values would be too large are refused.
    """
    table = value.get("types") if isinstance(value, dict) else None
    if not isinstance(value, dict) or "idf_type" not in value or not isinstance(table, list):
        raise IdfError(
            f"type: found {kind_name(value)}, needs a dict with 'idf_type' and a list 'types'"
        )
    version = value["idf_type"]
    if kind_name(version) != "int32" or version != _VERSION:
        raise IdfError(f"type: its version is not {_VERSION}, the only one known")
    known: list[_Sized] = []
    nodes = 0
    for index, entry in enumerate(table):
        try:
            known.append(_read_entry(entry, known))
        except IdfError as error:
            raise IdfError(f"type: entry {index}: {error}") from None
        nodes += known[-1].nodes
        if nodes > _MAX_TABLE_NODES:
            raise IdfError(f"type: entry {index}: the table needs over {_MAX_TABLE_NODES} nodes")
    if not known:
        raise IdfError("type: the table is empty, needs one entry at least")
    return known[-1].type


class _Sized:
    """A type with what its values take, counted once."""

    def __init__(self, made: Type, inner: list[tuple[_Sized, int]]) -> None:
        self.type = made
        self.depth: int = 1 + max((part.depth for part, _ in inner), default=0)
        self.nodes: int = 1 + sum(part.nodes * times for part, times in inner)
        self.default_bytes: int = sum(part.default_bytes * times for part, times in inner)
        if isinstance(made, types.Pose):
            self.depth, self.nodes = 2, 3
        array = types.as_array(made)
        if array is not None:
            sizes = math.prod(max(size, 0) for size in array.shape)
            self.default_bytes = sizes * np.dtype(array.element).itemsize


class _Entry:
    """One entry of the table, or a dict inside it."""

    def __init__(self, value: object, known: list[_Sized]) -> None:
        if not isinstance(value, dict):
            raise IdfError(f"found {kind_name(value)}, needs dict")
        self._value = value
        self._known = known
        self.used: list[tuple[_Sized, int]] = []

    def has(self, key: str) -> bool:
        return key in self._value

    def get(self, key: str, needed: str) -> Any:
        """The value of a member, which is of the kind `needed`."""
        found = kind_name(self._value[key]) if key in self._value else "nothing"
        if found != needed:
            raise IdfError(f"'{key}': found {found}, needs {needed}")
        value = self._value[key]
        return int(value) if needed.startswith("int") else value

    def text(self, key: str) -> str:
        return str(self.get(key, "string")) if self.has(key) else ""

    def name_of(self, key: str, known: Any) -> str:
        name = str(self.get(key, "string"))
        if name not in known:
            raise IdfError(f"'{key}': '{name}' is not known")
        return name

    def size(self, key: str) -> int:
        return _checked_size(self.get(key, "int64"))

    def type_at(self, key: str, index: object, times: int = 1) -> Any:
        if kind_name(index) == "int32" and 0 <= int(index) < len(self._known):  # type: ignore
            used = self._known[int(index)]  # type: ignore[call-overload]
            self.used.append((used, times))
            return used.type
        found = kind_name(index)
        raise IdfError(f"'{key}': found {found}, needs the int32 index of an entry before")

    def type_of(self, key: str, times: int = 1) -> Any:
        return self.type_at(key, self._value.get(key), times)

    def dicts(self, key: str) -> list[_Entry]:
        made = [_Entry(value, self._known) for value in self.get(key, "list")]
        for entry in made:
            entry.used = self.used
        return made

    def quantity(self) -> dict[str, Any]:
        bounds = {
            key: float(self.get(key, "float64")) if self.has(key) else None
            for key in ("minimum", "maximum")
        }
        return {"unit": self.text("unit"), **bounds}


def _checked_size(size: int) -> int:
    if size < 0 and size != types.FREE_SIZE:
        raise IdfError(f"size {size}: needs zero or more, or {types.FREE_SIZE} for a free one")
    return size


def _read_entry(value: object, known: list[_Sized]) -> _Sized:
    entry = _Entry(value, known)
    kind = entry.name_of("kind", types.KINDS)
    optional = bool(entry.get("optional", "bool")) if entry.has("optional") else False
    common: dict[str, Any] = {"optional": optional, "doc": entry.text("doc")}
    made = _Sized(types.KINDS[kind](**common, **_members_of(kind, entry)), entry.used)
    _check(made)
    return made


def _members_of(kind: str, entry: _Entry) -> dict[str, Any]:
    """What a type of this kind says beside being optional and documented."""
    if kind in _NUMBER_ELEMENTS:
        return entry.quantity()
    if kind == "NDArray":
        return {"element": _element(entry), "shape": _shape(entry), **entry.quantity()}
    if kind == "Matrix":
        sizes = {"rows": entry.size("rows"), "cols": entry.size("cols")}
        return {"element": _element(entry), **sizes, **entry.quantity()}
    if kind in ("Quaternion", "Orientation", "Pose"):
        return {"element": entry.name_of("element", ("float32", "float64"))}
    if kind == "Image":
        sizes = {"height": entry.size("height"), "width": entry.size("width")}
        return {"pixel": entry.name_of("pixel", types.PIXELS), **sizes}
    if kind == "PointCloud":
        return {"point": entry.name_of("point", types.POINT_FIELDS), "count": entry.size("count")}
    if kind == "List":
        size = entry.size("size")
        return {"element": entry.type_of("element", 1 if size < 0 else size), "size": size}
    if kind == "Dict":
        return {"element": entry.type_of("element")}
    if kind == "Tuple":
        indices = entry.get("elements", "list")
        return {"elements": tuple(entry.type_at("elements", index) for index in indices)}
    if kind == "Pair":
        return {"first": entry.type_of("first"), "second": entry.type_of("second")}
    if kind == "IntEnum":
        return {"name": entry.get("name", "string"), "values": _enum_values(entry)}
    return _object(entry) if kind == "Object" else {}


def _element(entry: _Entry) -> str:
    return entry.name_of("element", ELEMENT_NAMES)


def _shape(entry: _Entry) -> tuple[int, ...]:
    sizes = entry.get("shape", "list")
    if len(sizes) > _MAX_RANK:
        raise IdfError(f"has {len(sizes)} axes, at most {_MAX_RANK} are known")
    if any(kind_name(size) != "int64" for size in sizes):
        raise IdfError("'shape': needs a list of int64")
    return tuple(_checked_size(int(size)) for size in sizes)


def _enum_values(entry: _Entry) -> tuple[types.EnumValue, ...]:
    return tuple(
        types.EnumValue(value.get("name", "string"), value.get("value", "int32"), value.text("doc"))
        for value in entry.dicts("values")
    )


def _object(entry: _Entry) -> dict[str, Any]:
    base = entry.type_of("base", 1) if entry.has("base") else None
    if base is not None and (not isinstance(base, types.Object) or base.optional):
        raise IdfError(f"extends {base.kind}, needs an Object that is not optional")
    members = tuple(
        types.Member(member.get("name", "string"), member.type_of("type"), member.text("doc"))
        for member in entry.dicts("members")
    )
    return {"name": entry.get("name", "string"), "base": base, "members": members}


def _check(made: _Sized) -> None:
    """Raises IdfError for what no type may be."""
    of = made.type
    if isinstance(of, types.IntEnum):
        _check_unique("name", [value.name for value in of.values])
        _check_unique("value", [str(value.value) for value in of.values])
        if not of.values:
            raise IdfError("has no value, needs one at least")
    if isinstance(of, types.Object):
        _check_unique("member", [member.name for member in of.all_members])
    if isinstance(of, types.Quantity):
        _check_bounds(of)
    for found, max_count, what in (
        (made.depth, _MAX_DEPTH, "levels"),
        (made.nodes, _MAX_NODES, "nodes"),
        (made.default_bytes, _MAX_DEFAULT_BYTES, "bytes of arrays in its default value"),
    ):
        if found > max_count:
            raise IdfError(f"has {found} {what}, at most {max_count} are allowed")


def _check_unique(what: str, names: list[str]) -> None:
    seen = set()
    for name in names:
        if name in seen:
            raise IdfError(f"{what} '{name}' is there twice")
        seen.add(name)


def _check_bounds(of: types.Quantity) -> None:
    array = types.as_array(of)
    element = array.element if array is not None else _NUMBER_ELEMENTS[of.kind]
    if not all(math.isfinite(bound) for bound in (of.minimum, of.maximum) if bound is not None):
        raise IdfError("a bound is not finite")
    if closest_to_zero(of, np.dtype(element)) is None:
        raise IdfError(f"no {element} lies within the bounds {of.minimum}..{of.maximum}")
