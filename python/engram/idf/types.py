# SPDX-License-Identifier: Apache-2.0
"""Types of values: which values are meant, and what they mean. Source: docs/idf.md, "Types".

A mirror of ltm/idf/type.h. Types are immutable and compare by all that they say.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

FREE_SIZE = -1
"""An axis or a length that may differ from value to value."""

PIXELS = {
    "rgb24": ("uint8", 3),
    "mono8": ("uint8", 1),
    "depth32": ("float32", 1),
    "depth16": ("uint16", 1),
}
"""Element type and channels of images."""

POINT_FIELDS = {
    "XYZ": 3,
    "XYZI": 4,
    "XYZL": 4,
    "XYZRGB": 6,
    "XYZRGBA": 7,
    "XYZRGBL": 7,
    "XYZNormal": 6,
    "XYZRGBNormal": 9,
}
"""Numbers per point."""


@dataclass(frozen=True, kw_only=True)
class Type:
    """Any type; `kind` is its name in XML."""

    optional: bool = False
    doc: str = ""

    @property
    def kind(self) -> str:
        return type(self).__name__

    def with_optional(self, optional: bool = True) -> Self:
        return replace(self, optional=optional)

    def with_doc(self, doc: str) -> Self:
        return replace(self, doc=doc)


@dataclass(frozen=True)
class ArrayType:
    """Element type and shape of an ndarray, FREE_SIZE where an axis may have any size."""

    element: str
    shape: tuple[int, ...]

    def admits(self, shape: tuple[int, ...]) -> bool:
        return len(shape) == len(self.shape) and all(
            needed in (FREE_SIZE, size) for needed, size in zip(self.shape, shape)
        )


@dataclass(frozen=True, kw_only=True)
class Quantity(Type):
    """Numbers with a unit and inclusive bounds; NaN and infinities are out of bounds."""

    unit: str = ""
    minimum: float | None = None
    maximum: float | None = None

    @property
    def is_bounded(self) -> bool:
        return self.minimum is not None or self.maximum is not None


@dataclass(frozen=True, kw_only=True)
class Int(Quantity):
    """int32"""


@dataclass(frozen=True, kw_only=True)
class Long(Quantity):
    """int64"""


@dataclass(frozen=True, kw_only=True)
class Float(Quantity):
    """float32"""


@dataclass(frozen=True, kw_only=True)
class Double(Quantity):
    """float64"""


@dataclass(frozen=True, kw_only=True)
class String(Type):
    """string"""


@dataclass(frozen=True, kw_only=True)
class Bool(Type):
    """bool"""


@dataclass(frozen=True, kw_only=True)
class Time(Type):
    """int64, ns since the Unix epoch, UTC"""


@dataclass(frozen=True, kw_only=True)
class MemoryLink(Type):
    """string, a printed MemoryID; empty: no link"""


@dataclass(frozen=True)
class EnumValue:
    name: str
    value: int
    doc: str = ""


@dataclass(frozen=True, kw_only=True)
class IntEnum(Type):
    """int32, one of the named values"""

    name: str
    values: tuple[EnumValue, ...]
    python: Any = field(default=None, compare=False, repr=False)
    """The class that its values are read as; None: plain int."""


@dataclass(frozen=True, kw_only=True)
class NDArray(Quantity):
    """ndarray of the shape"""

    element: str = "float32"
    shape: tuple[int, ...]


@dataclass(frozen=True, kw_only=True)
class Matrix(Quantity):
    """ndarray [rows, cols]"""

    element: str = "float32"
    rows: int = FREE_SIZE
    cols: int = FREE_SIZE


@dataclass(frozen=True, kw_only=True)
class Quaternion(Type):
    """ndarray [4]: w, x, y, z"""

    element: str = "float32"


@dataclass(frozen=True, kw_only=True)
class Orientation(Type):
    """the same, norm 1 within 0.001"""

    element: str = "float32"


@dataclass(frozen=True, kw_only=True)
class Pose(Type):
    """dict {position: ndarray [3] in m, orientation: ndarray [4]}"""

    element: str = "float32"


@dataclass(frozen=True, kw_only=True)
class Image(Type):
    """ndarray [height, width, channels]"""

    pixel: str
    height: int = FREE_SIZE
    width: int = FREE_SIZE


@dataclass(frozen=True, kw_only=True)
class PointCloud(Type):
    """ndarray float32 [points, fields]"""

    point: str
    count: int = FREE_SIZE


@dataclass(frozen=True, kw_only=True)
class List(Type):
    """list"""

    element: Type
    size: int = FREE_SIZE


@dataclass(frozen=True, kw_only=True)
class Tuple(Type):
    """list of exactly that many elements"""

    elements: tuple[Type, ...]


@dataclass(frozen=True, kw_only=True)
class Dict(Type):
    """dict of any keys"""

    element: Type


@dataclass(frozen=True, kw_only=True)
class Pair(Type):
    """list of exactly two elements"""

    first: Type
    second: Type


@dataclass(frozen=True)
class Member:
    name: str
    type: Type
    doc: str = ""


@dataclass(frozen=True, kw_only=True)
class Object(Type):
    """dict with exactly its members"""

    name: str
    members: tuple[Member, ...]
    """Its own; all_members has those of the base before them."""
    base: Object | None = None
    python: Any = field(default=None, compare=False, repr=False)
    """The class that its values are read as; None: plain dict."""

    @cached_property
    def all_members(self) -> tuple[Member, ...]:
        return self.members if self.base is None else self.base.all_members + self.members


KINDS: dict[str, type[Type]] = {
    kind.__name__: kind
    for kind in (
        Int,
        Long,
        Float,
        Double,
        String,
        Bool,
        Time,
        MemoryLink,
        IntEnum,
        NDArray,
        Matrix,
        Quaternion,
        Orientation,
        Pose,
        Image,
        PointCloud,
        List,
        Tuple,
        Dict,
        Object,
        Pair,
    )
}
"""The classes by the names that are stored."""


def as_array(of: Type) -> ArrayType | None:
    """The ndarray that a value of this type is; None where it is none."""
    if isinstance(of, NDArray):
        return ArrayType(of.element, of.shape)
    if isinstance(of, Matrix):
        return ArrayType(of.element, (of.rows, of.cols))
    if isinstance(of, (Quaternion, Orientation)):
        return ArrayType(of.element, (4,))
    if isinstance(of, Image):
        element, channels = PIXELS[of.pixel]
        return ArrayType(element, (of.height, of.width, channels))
    if isinstance(of, PointCloud):
        return ArrayType("float32", (of.count, POINT_FIELDS[of.point]))
    return None


def parts(of: Type) -> tuple[Member, ...]:
    """Types directly inside; the names are empty for what a list or dict repeats."""
    if isinstance(of, (List, Dict)):
        return (Member("", of.element),)
    if isinstance(of, Tuple):
        return tuple(Member(str(i), element) for i, element in enumerate(of.elements))
    if isinstance(of, Pair):
        return (Member("0", of.first), Member("1", of.second))
    if isinstance(of, Object):
        return of.all_members
    if isinstance(of, Pose):
        position = NDArray(element=of.element, shape=(3,), unit="m")
        orientation = Orientation(element=of.element)
        return (Member("position", position), Member("orientation", orientation))
    return ()


def describe(of: Type) -> str:
    """ "int32", "ndarray float32 [*, 3]", "dict (Object Cup)": its values in a few words."""
    array = as_array(of)
    if array is not None:
        sizes = ", ".join("*" if size == FREE_SIZE else str(size) for size in array.shape)
        return f"ndarray {array.element} [{sizes}]"
    if isinstance(of, IntEnum):
        values = ", ".join(f"{value.name} = {value.value}" for value in of.values)
        return f"int32 of IntEnum {of.name}{{{values}}}"
    if isinstance(of, (Tuple, Pair)):
        return f"list of {len(parts(of))} ({of.kind})"
    if isinstance(of, Object):
        return f"dict (Object {of.name})"
    if isinstance(of, List):
        return "list" if of.size == FREE_SIZE else f"list of {of.size}"
    return _PLAIN_TEXTS[of.kind]


_PLAIN_TEXTS = {
    "Int": "int32",
    "Long": "int64",
    "Float": "float32",
    "Double": "float64",
    "String": "string",
    "Bool": "bool",
    "Time": "int64 (Time)",
    "MemoryLink": "string (MemoryLink)",
    "Dict": "dict",
    "Pose": "dict (Pose)",
}
