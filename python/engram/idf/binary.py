# SPDX-License-Identifier: Apache-2.0
"""The binary form of values. Source: docs/format.md, section "IDF binary form"."""

from __future__ import annotations

from typing import Any

import numpy as np

from engram.idf.errors import IdfError
from engram.idf.value import ELEMENT_NAMES, Value, element_name, kind_name, normal_array

MAX_DEPTH = 64
"""Deepest nesting of lists and dicts."""

_MAGIC = b"IDF\x01"
_ALIGNMENT = 8
_MAX_RANK = 16
_NONE, _FALSE, _TRUE, _INT32, _INT64, _FLOAT32, _FLOAT64 = range(7)
_STRING, _NDARRAY, _LIST, _DICT = range(7, 11)
_SCALARS: dict[int, type[np.generic]] = {
    _INT32: np.int32,
    _INT64: np.int64,
    _FLOAT32: np.float32,
    _FLOAT64: np.float64,
}
_SCALAR_TAGS = {scalar.__name__: tag for tag, scalar in _SCALARS.items()}
_LITTLE = {tag: np.dtype(scalar).newbyteorder("<") for tag, scalar in _SCALARS.items()}


def encode(value: object) -> bytes:
    """The bytes of a value.

    A plain int is written as int64, a plain float as float64, a tuple as a list. Arrays that are
    not row-major and little-endian are made so.
    Raises IdfError where the value nests too deep, is of no IDF kind or has an integer beyond 64
    bits.
    """
    writer = _Writer()
    writer.write(value, MAX_DEPTH)
    return b"".join(writer.parts)


def decode(data: Any) -> Value:
    """Reads the binary form from bytes, a memoryview or any other contiguous buffer.

    Arrays are read-only views into the buffer and keep it alive; they are copied only where the
    buffer lies so that they would not be aligned.
    Raises IdfError naming the offset, what was found and what was needed. Safe on hostile bytes:
    depth, counts and lengths are checked before anything is allocated.
    """
    return _Reader(memoryview(data).cast("B")).read_all()


def _padding(offset: int) -> int:
    return -offset % _ALIGNMENT


class _Writer:
    def __init__(self) -> None:
        self.parts: list[bytes | memoryview] = [_MAGIC]
        self._size = len(_MAGIC)

    def write(self, value: Any, levels: int) -> None:
        kind = kind_name(value)
        if kind == "none":
            self._bytes(bytes((_NONE,)))
        elif kind == "bool":
            self._bytes(bytes((_TRUE if value else _FALSE,)))
        elif kind in _SCALAR_TAGS:
            self._scalar(_SCALAR_TAGS[kind], value)
        elif kind == "string":
            self._bytes(bytes((_STRING,)))
            self._text(value)
        elif kind == "ndarray":
            self._array(value)
        else:
            self._container(value, levels)

    def _bytes(self, data: bytes | memoryview) -> None:
        self.parts.append(data)
        self._size += len(data)

    def _varint(self, value: int) -> None:
        made = bytearray()
        while value >= 0x80:
            made.append(value & 0x7F | 0x80)
            value >>= 7
        made.append(value)
        self._bytes(bytes(made))

    def _scalar(self, tag: int, value: Any) -> None:
        if isinstance(value, int) and not -(2**63) <= value < 2**63:
            raise IdfError(f"IDF value: the integer {value} exceeds 64 bits")
        # By way of an array of the type: struct would turn a float32 into a double and change NaNs.
        self._bytes(bytes((tag,)) + np.asarray(value, _LITTLE[tag]).tobytes())

    def _text(self, text: str) -> None:
        try:
            data = text.encode("utf-8", "surrogateescape")
        except UnicodeEncodeError as error:
            raise IdfError(f"IDF value: a string is no text: {error}") from None
        self._varint(len(data))
        self._bytes(data)

    def _array(self, array: Any) -> None:
        if array.ndim > _MAX_RANK:
            raise IdfError(f"IDF value: has an ndarray of rank {array.ndim}, at most {_MAX_RANK}")
        code = ELEMENT_NAMES.index(element_name(array)) + 1
        self._bytes(bytes((_NDARRAY, code, array.ndim)))
        for size in array.shape:
            self._varint(size)
        self._bytes(bytes(_padding(self._size)))
        if array.size > 0:
            self._bytes(normal_array(array).reshape(-1).view(np.uint8).data)

    def _container(self, value: Any, levels: int) -> None:
        if levels <= 0:
            raise IdfError(f"IDF value: nests deeper than {MAX_DEPTH} levels")
        is_dict = isinstance(value, dict)
        self._bytes(bytes((_DICT if is_dict else _LIST,)))
        self._varint(len(value))
        for part in value:
            if not is_dict:
                self.write(part, levels - 1)
                continue
            if not isinstance(part, str):
                raise IdfError(f"IDF value: a dict has the key {part!r}, needs a string")
            self._text(part)
            self.write(value[part], levels - 1)


class _Reader:
    def __init__(self, data: memoryview) -> None:
        self._data = data
        self._at = 0

    def read_all(self) -> Value:
        if bytes(self._data[: len(_MAGIC)]) != _MAGIC:
            raise IdfError(
                f"IDF bytes: needs the header 'IDF' and version 1, found {len(self._data)} other "
                "bytes"
            )
        self._at = len(_MAGIC)
        value = self._read(MAX_DEPTH)
        if self._left() > 0:
            raise IdfError(f"IDF bytes: {self._left()} bytes after the value at offset {self._at}")
        return value

    def _left(self) -> int:
        return len(self._data) - self._at

    def _error(self, what: str) -> IdfError:
        return IdfError(f"IDF bytes at offset {self._at}: {what}")

    def _byte(self, what: str) -> int:
        if self._left() == 0:
            raise self._error(what)
        self._at += 1
        return self._data[self._at - 1]

    def _read(self, levels: int) -> Value:
        tag = self._byte("the bytes end where a value must start")
        if tag <= _TRUE:
            return None if tag == _NONE else tag == _TRUE
        if tag in _SCALARS:
            scalar: Value = self._scalar(tag)
            return scalar
        if tag == _STRING:
            return self._text()
        if tag == _NDARRAY:
            array: Value = self._array()
            return array
        if tag == _LIST:
            return self._list(levels)
        if tag == _DICT:
            return self._dict(levels)
        self._at -= 1
        raise self._error(f"unknown tag {tag}")

    def _scalar(self, tag: int) -> Any:
        dtype = _LITTLE[tag]
        if self._left() < dtype.itemsize:
            raise self._error("the bytes end inside a number")
        self._at += dtype.itemsize
        start = self._at - dtype.itemsize
        return _SCALARS[tag](np.frombuffer(self._data, dtype, 1, start)[0])

    def _varint(self) -> int:
        value = 0
        for shift in range(0, 64, 7):
            byte = self._byte("the bytes end inside a length")
            if shift == 63 and byte > 1:
                break
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                return value
        raise self._error("a length exceeds 64 bits")

    def _count(self, min_size: int) -> int:
        """A number of things of which each takes at least `min_size` of the bytes that are left."""
        announced = self._varint()
        if announced > self._left() // min_size:
            raise self._error(f"{announced} elements announced, {self._left()} bytes left")
        return announced

    def _text(self) -> str:
        size = self._count(1)
        self._at += size
        return str(self._data[self._at - size : self._at], "utf-8", "surrogateescape")

    def _array(self) -> Any:
        if self._left() < 2:
            raise self._error("the bytes end inside an ndarray")
        code, rank = self._data[self._at], self._data[self._at + 1]
        if not 1 <= code <= len(ELEMENT_NAMES) or rank > _MAX_RANK:
            raise self._error("an ndarray of unknown type or rank above 16")
        self._at += 2
        shape = tuple(self._axis() for _ in range(rank))
        dtype = np.dtype(ELEMENT_NAMES[code - 1]).newbyteorder("<")
        start = self._at + _padding(self._at)
        size = 1
        for axis in shape:
            size *= axis
        if start + size * dtype.itemsize > len(self._data):
            raise self._error(
                f"an ndarray {ELEMENT_NAMES[code - 1]} {list(shape)} exceeds the {self._left()} "
                "bytes left"
            )
        self._at = start + size * dtype.itemsize
        return self._view(dtype, shape, size, start)

    def _axis(self) -> int:
        size = self._varint()
        if size >= 2**63:
            raise self._error("an axis of an ndarray exceeds 63 bits")
        return size

    def _view(self, dtype: np.dtype[Any], shape: tuple[int, ...], size: int, start: int) -> Any:
        try:
            if size == 0:
                array = np.empty(shape, dtype)
            else:
                array = np.frombuffer(self._data, dtype, size, start).reshape(shape)
        except ValueError as error:  # An empty array with axes that NumPy cannot count.
            raise self._error(f"an ndarray of shape {list(shape)}: {error}") from None
        if not array.flags.aligned:
            array = array.copy()
        array.flags.writeable = False
        return array

    def _list(self, levels: int) -> list[Value]:
        self._check_levels(levels)
        return [self._read(levels - 1) for _ in range(self._count(1))]

    def _dict(self, levels: int) -> dict[str, Value]:
        self._check_levels(levels)
        made: dict[str, Value] = {}
        for _ in range(self._count(2)):
            key = self._text()
            if key in made:
                raise self._error(f"a dict has the key '{key}' twice")
            made[key] = self._read(levels - 1)
        return made

    def _check_levels(self, levels: int) -> None:
        if levels <= 0:
            raise self._error(f"nests too deep, at most {MAX_DEPTH} levels are allowed")
