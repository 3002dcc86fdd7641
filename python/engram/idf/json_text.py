# SPDX-License-Identifier: Apache-2.0
"""The JSON form of values. Source: ltm/idf/json.h."""

from __future__ import annotations

import base64
import binascii
import json
import math
import re
from typing import Any

import numpy as np
import numpy.typing as npt

from engram.idf.binary import MAX_DEPTH
from engram.idf.errors import IdfError
from engram.idf.value import ELEMENT_NAMES, Value, element_name, join_path, kind_name, normal_array

_BASE64_FROM_COUNT = 64
_LARGEST_EXACT_INT = 2**53
_MAX_NUMPY_RANK = 32
_PLAIN_NAN = {"float32": 0x7FC00000, "float64": 0x7FF8000000000000}
# Where the decimal point of plain notation may stand; beyond it exponents are printed.
_MIN_POINT, _MAX_POINT = -3, 15


def to_json(value: object) -> str:
    """The value as JSON on one line, as ltm/idf/json.h describes it.

    The text is the one that the C++ side prints, but for the rare doubles for which its printer
    finds more digits than are needed; the value read back is the same always.
    Raises IdfError where the value nests deeper than 64 levels, is of no kind, or a string is no
    UTF-8.
    """
    text = _write(value, 0)
    try:
        text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise IdfError(f"IDF value has a string that is not UTF-8: {error}") from None
    return text


def from_json(text: str) -> Value:
    """Reads the JSON form. Raises IdfError naming the path, what was found and what was needed."""
    try:
        text.encode("utf-8")
        parsed = json.loads(
            text.removeprefix("\ufeff"),
            parse_int=_parse_int,
            parse_float=_parse_float,
            parse_constant=_refuse_constant,
        )
        return _read(parsed, "", 0)
    except RecursionError:
        raise IdfError("no JSON: nests too deep") from None
    except (json.JSONDecodeError, UnicodeEncodeError) as error:
        raise IdfError(f"no JSON: {error}") from None


def _write(value: Any, depth: int) -> str:
    kind = kind_name(value)
    if kind in ("none", "bool", "string"):
        plain = bool(value) if kind == "bool" else value
        return json.dumps(plain, ensure_ascii=False)
    if kind == "int32":
        return f'{{"$int32":{value}}}'
    if kind == "int64":
        return _write_int64(int(value))
    if kind == "float64" and math.isfinite(value):
        return _write_double(float(value))
    if kind.startswith("float"):
        return f'{{"${kind}":{_write_float(value, kind)}}}'
    if kind == "ndarray":
        return _write_array(value)
    if depth >= MAX_DEPTH and len(value) > 0:
        raise IdfError(f"IDF value: nests deeper than {MAX_DEPTH} levels")
    if kind == "list":
        return "[" + ",".join(_write(part, depth + 1) for part in value) + "]"
    return "{" + ",".join(_write_entry(key, part, depth + 1) for key, part in value.items()) + "}"


def _write_entry(key: Any, value: Any, depth: int) -> str:
    if not isinstance(key, str):
        raise IdfError(f"IDF value: a dict has the key {key!r}, needs a string")
    name = "$" + key if key.startswith("$") else key
    return f"{json.dumps(name, ensure_ascii=False)}:{_write(value, depth)}"


def _write_int64(value: int) -> str:
    if abs(value) < _LARGEST_EXACT_INT:
        return str(value)
    if not -(2**63) <= value < 2**63:
        raise IdfError(f"IDF value: the integer {value} exceeds 64 bits")
    return f'{{"$int64":"{value}"}}'


def _write_float(value: Any, kind: str) -> str:
    """A float; a NaN with other bits than the plain one spells them."""
    if math.isfinite(value):
        return _write_double(float(value))
    if math.isinf(value):
        return '"inf"' if value > 0 else '"-inf"'
    bits = int.from_bytes(np.asarray(value, np.dtype(kind).newbyteorder("<")).tobytes(), "little")
    return '"nan"' if bits == _PLAIN_NAN[kind] else f'"nan:{bits:x}"'


def _write_double(value: float) -> str:
    """The shortest digits that read back, in the notation of the C++ side."""
    mantissa, _, exponent = f"{value!r}".partition("e")
    sign = "-" if mantissa.startswith("-") else ""
    whole, _, fraction = mantissa.removeprefix("-").partition(".")
    digits = (whole + fraction).lstrip("0")
    point = len(digits) - len(fraction) + int(exponent or 0)
    digits = digits.rstrip("0")
    if not digits:
        return sign + "0.0"
    if _MIN_POINT <= point <= 0:
        return f"{sign}0.{'0' * -point}{digits}"
    if 0 < point <= _MAX_POINT:
        padded = digits.ljust(point, "0")
        return f"{sign}{padded[:point]}.{padded[point:] or '0'}"
    rest = f".{digits[1:]}" if len(digits) > 1 else ""
    return f"{sign}{digits[0]}{rest}e{point - 1:+03d}"


def _write_array(array: npt.NDArray[Any]) -> str:
    name = element_name(array)
    plain = normal_array(array)
    shape = ",".join(str(size) for size in plain.shape)
    if plain.size >= _BASE64_FROM_COUNT:
        elements = f'"base64":"{base64.b64encode(plain.tobytes()).decode("ascii")}"'
    else:
        flat = plain.reshape(-1)
        is_float = plain.dtype.kind == "f"
        texts = (_write_float(one, name) if is_float else str(one) for one in flat)
        elements = f'"data":[{",".join(texts)}]'
    return f'{{"$ndarray":{{"type":"{name}","shape":[{shape}],{elements}}}}}'


def _parse_int(text: str) -> int | float:
    """Integers that 64 bits do not hold are floats, as on the C++ side."""
    if len(text) <= 20 and -(2**63) <= int(text) < 2**64:
        return int(text)
    return _parse_float(text)


def _parse_float(text: str) -> float:
    value = float(text)
    if math.isinf(value):
        raise IdfError(f"no JSON: the number {text[:40]} exceeds float64")
    return value


def _refuse_constant(text: str) -> Any:
    raise IdfError(f"no JSON: found {text}, needs a value")


def _broken(path: str, found: str) -> IdfError:
    return IdfError(f"JSON at '/{path}': found {found}, which is no IDF value")


def _read(parsed: Any, path: str, depth: int) -> Value:
    if parsed is None or isinstance(parsed, bool):
        return parsed
    if isinstance(parsed, int):
        if parsed >= 2**63:
            raise _broken(path, "an integer beyond int64")
        return np.int64(parsed)
    if isinstance(parsed, float):
        return np.float64(parsed)
    if isinstance(parsed, str):
        return _read_text(parsed, path)
    if isinstance(parsed, dict) and len(parsed) == 1:
        tag = next(iter(parsed))
        if tag.startswith("$") and not tag.startswith("$$"):
            return _read_typed(tag, parsed[tag], path)
    if depth >= MAX_DEPTH:
        raise _broken(path, "more than 64 levels")
    if isinstance(parsed, list):
        return [_read(part, join_path(path, i), depth + 1) for i, part in enumerate(parsed)]
    return _read_dict(parsed, path, depth)


def _read_text(text: str, path: str) -> str:
    if any("\ud800" <= letter <= "\udfff" for letter in text):
        raise _broken(path, "a lone surrogate in a string")
    return text


def _read_dict(parsed: dict[str, Any], path: str, depth: int) -> dict[str, Value]:
    made: dict[str, Value] = {}
    for key, value in parsed.items():
        if key.startswith("$") and not key.startswith("$$"):
            raise _broken(path, f"the type tag '{key}' beside other keys")
        name = _read_text(key[1:] if key.startswith("$$") else key, path)
        made[name] = _read(value, join_path(path, name), depth + 1)
    return made


def _read_typed(tag: str, parsed: Any, path: str) -> Value:
    value: Value = None
    if tag == "$int32" and _is_int(parsed) and -(2**31) <= parsed < 2**31:
        value = np.int32(parsed)
    elif tag == "$int64" and isinstance(parsed, str) and re.fullmatch(r"-?[0-9]{1,400}", parsed):
        if -(2**63) <= int(parsed) < 2**63:
            value = np.int64(int(parsed))
    elif tag in ("$float32", "$float64"):
        value = _read_float(parsed, tag[1:])
    elif tag == "$ndarray" and isinstance(parsed, dict):
        return _read_array(parsed, path)
    if value is None:
        raise _broken(path, f"a {tag} with an unfitting value")
    return value


def _is_int(parsed: Any) -> bool:
    return isinstance(parsed, int) and not isinstance(parsed, bool)


def _read_float(parsed: Any, kind: str) -> Any:
    """A float of `kind`; None where `parsed` is none."""
    dtype = np.dtype(kind)
    if isinstance(parsed, str):
        return _read_unusual_float(parsed, dtype)
    if not isinstance(parsed, float) and not _is_int(parsed):
        return None
    return dtype.type(parsed) if abs(float(parsed)) <= float(np.finfo(dtype).max) else None


def _read_unusual_float(text: str, dtype: np.dtype[Any]) -> Any:
    if text in ("inf", "-inf"):
        return dtype.type(text)
    if text == "nan":
        bits = _PLAIN_NAN[dtype.name]
    elif re.fullmatch(r"nan:[0-9a-fA-F]{1,400}", text):
        bits = int(text[4:], 16)
    else:
        return None
    if bits >= 2 ** (8 * dtype.itemsize):
        return None
    value = np.frombuffer(bits.to_bytes(dtype.itemsize, "little"), dtype.newbyteorder("<"))[0]
    return value if math.isnan(value) else None


def _read_array(parsed: dict[str, Any], path: str) -> npt.NDArray[Any]:
    name, shape = parsed.get("type"), parsed.get("shape")
    if not isinstance(name, str) or not isinstance(shape, list):
        raise _broken(path, "an ndarray without type and shape")
    if name not in ELEMENT_NAMES:
        raise _broken(path, "an ndarray of unknown element type")
    if not all(_is_int(size) and size < 2**63 for size in shape):
        raise _broken(path, "an ndarray whose shape is not of integers")
    elements = _read_elements(parsed, np.dtype(name), path)
    if len(shape) > _MAX_NUMPY_RANK or min(shape, default=0) < 0:
        raise _broken(path, f"an ndarray of shape {shape[:40]}")
    try:
        array = elements.reshape(shape)
    except ValueError:
        raise _broken(path, f"{elements.size} elements for an ndarray of shape {shape}") from None
    array.flags.writeable = False
    return array


def _read_elements(parsed: dict[str, Any], dtype: np.dtype[Any], path: str) -> npt.NDArray[Any]:
    packed, data = parsed.get("base64"), parsed.get("data")
    if isinstance(packed, str):
        return _unpacked(packed, dtype, path)
    if not isinstance(data, list):
        raise _broken(path, "an ndarray without data or base64")
    array = np.empty(len(data), dtype)
    for i, element in enumerate(data):
        if dtype.kind == "f":
            number = _read_float(element, dtype.name)
        else:
            number = element if _fits_integer(element, dtype) else None
        if number is None:
            raise _broken(path, "an ndarray element that does not fit its type")
        array[i] = number
    return array


def _fits_integer(element: Any, dtype: np.dtype[Any]) -> bool:
    limits = np.iinfo(dtype)
    return _is_int(element) and int(limits.min) <= element <= int(limits.max)


def _unpacked(packed: str, dtype: np.dtype[Any], path: str) -> npt.NDArray[Any]:
    try:
        data = base64.b64decode(packed, validate=True)
    except (binascii.Error, ValueError):
        raise _broken(path, "an ndarray with broken base64") from None
    if base64.b64encode(data).decode("ascii") != packed:
        raise _broken(path, "an ndarray with broken base64")
    if len(data) % dtype.itemsize != 0:
        raise _broken(path, f"{len(data)} bytes for an ndarray of {dtype.name}")
    return np.frombuffer(data, dtype.newbyteorder("<")).copy()
