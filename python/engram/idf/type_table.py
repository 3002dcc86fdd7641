# SPDX-License-Identifier: Apache-2.0
"""Types as the values that segments store and servers are told: what type_from_data reads."""

from __future__ import annotations

from typing import Any

import numpy as np

from engram.idf import types
from engram.idf.binary import encode
from engram.idf.types import Type
from engram.idf.value import Value

#: Members of types that are written as they are, by the kind of the value.
_TEXTS = ("element", "pixel", "point", "name")
_SIZES = ("rows", "cols", "height", "width", "count", "size")


def type_to_data(of: Type) -> dict[str, Value]:
    """The value that a type is stored as; see docs/idf.md, "Types as values"."""
    table = _Table()
    table.add(of)
    return {"idf_type": np.int32(1), "types": table.entries}


class _Table:
    """Equal types have one entry."""

    def __init__(self) -> None:
        self.entries: list[Value] = []
        self._known: dict[bytes, int] = {}

    def add(self, of: Type) -> np.int32:
        """The index of its entry."""
        entry: dict[str, Any] = {"kind": of.kind}
        if of.optional:
            entry["optional"] = True
        if of.doc:
            entry["doc"] = of.doc
        entry.update(self._members_of(of))
        index = self._known.setdefault(encode(entry), len(self.entries))
        if index == len(self.entries):
            self.entries.append(entry)
        return np.int32(index)

    def _members_of(self, of: Type) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for key in _TEXTS:
            if isinstance(text := getattr(of, key, None), str):
                found[key] = text
        for key in _SIZES:
            if isinstance(size := getattr(of, key, None), int):
                found[key] = np.int64(size)
        if isinstance(of, types.NDArray):
            found["shape"] = [np.int64(size) for size in of.shape]
        if isinstance(of, types.Quantity):
            found |= _quantity(of)
        if isinstance(of, types.IntEnum):
            found["values"] = [
                {"name": one.name, "value": np.int32(one.value), **_doc(one.doc)}
                for one in of.values
            ]
        return found | self._parts_of(of)

    def _parts_of(self, of: Type) -> dict[str, Any]:
        """Types inside, by the index of their entry."""
        if isinstance(of, (types.List, types.Dict)):
            return {"element": self.add(of.element)}
        if isinstance(of, types.Tuple):
            return {"elements": [self.add(one) for one in of.elements]}
        if isinstance(of, types.Pair):
            return {"first": self.add(of.first), "second": self.add(of.second)}
        if not isinstance(of, types.Object):
            return {}
        base = {} if of.base is None else {"base": self.add(of.base)}
        members = [
            {"name": one.name, "type": self.add(one.type), **_doc(one.doc)} for one in of.members
        ]
        return {**base, "members": members}


def _quantity(of: types.Quantity) -> dict[str, Any]:
    unit = {"unit": of.unit} if of.unit else {}
    bounds = {"minimum": of.minimum, "maximum": of.maximum}
    return {**unit, **{k: np.float64(v) for k, v in bounds.items() if v is not None}}


def _doc(doc: str) -> dict[str, str]:
    return {"doc": doc} if doc else {}
