# SPDX-License-Identifier: Apache-2.0
"""Messages of ROS 1 as parameters of skills, and as values; docs/skills.md, "ROS 1 actions".

Everything here looks at a message by `__slots__` and `_slot_types`, which every generated class
has, so nothing of ROS is imported.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from engram.errors import InvalidArgumentError
from engram.idf.value import Value
from engram.optional import needs

_INTEGERS = {f"{sign}int{bits}": (sign, bits) for sign in ("", "u") for bits in (8, 16, 32, 64)}
_INTEGERS |= {"byte": ("", 8), "char": ("u", 8)}
_FLOATS = {"float32": np.float32, "float64": np.float64}
_PLAIN = {*_INTEGERS, *_FLOATS, "bool", "string", "time", "duration"}
_POSITIONS = {"geometry_msgs/Point", "geometry_msgs/Vector3", "geometry_msgs/Point32"}
_ORIENTATION = "geometry_msgs/Quaternion"
_POSE = "geometry_msgs/Pose"
_HEADER = "std_msgs/Header"


def parameters_of(goal: type, frame: str = "") -> dict[str, dict[str, Any]]:
    """`parameters:` of the description of a skill, for the fields of a message's class.

    Fields of fields join their names by `_`; a field with its header alone, such as a PoseStamped,
    is that field. A header is a text, NAME_frame, with the default `frame`. Poses and positions
    must be given, because a pose of zeros is none; all else has the default that ROS has: zero,
    empty, false. An orientation alone is [1, 0, 0, 0]. Raises InvalidArgumentError where two fields
    would have one name.
    """
    found: dict[str, dict[str, Any]] = {}
    _describe(goal(), "", frame, found)
    return found


def message_of(goal: type, values: dict[str, Any], now: Any = None) -> Any:
    """A message with these parameters, as `parameters_of` names them. `now` becomes the stamp of its
    headers. Raises InvalidArgumentError naming the parameter that does not fit."""
    message = goal()
    _fill(message, "", values, now)
    return message


def value_of(message: Any) -> Value:
    """A message as a value: numbers, texts, arrays of numbers, lists and dicts; a pose has
    `position` and `orientation` [w, x, y, z]; times are ns since 1970, durations s."""
    if hasattr(message, "to_nsec") or not hasattr(message, "_slot_types"):
        return _plain_value(message)
    kind = message._type
    if kind in _POSITIONS:
        return np.array([message.x, message.y, message.z], np.float64)
    if kind == _ORIENTATION:
        return np.array([message.w, message.x, message.y, message.z], np.float64)
    return {
        name: _field_value(getattr(message, name), what)
        for name, what in zip(message.__slots__, message._slot_types, strict=True)
    }


def _element_of(what: str) -> str | None:
    """The type of the elements of an array; None: it is no array."""
    return what.partition("[")[0] if what.endswith("]") else None


def _name_of(message: Any, before: str, name: str, what: str) -> str:
    """The name of a parameter. `before`: that of the message, empty at the top."""
    if what == _HEADER:
        return f"{before or name}_frame"
    if not before:
        return name
    is_stamped = len(message.__slots__) == 2 and message._slot_types[0] == _HEADER
    return before if is_stamped else f"{before}_{name}"


def _length_of(what: str) -> int:
    """The length of an array that has one; 0 for any."""
    return int(what[what.index("[") + 1 : -1] or 0)


def _describe(message: Any, before: str, frame: str, found: dict[str, dict[str, Any]]) -> None:
    for name, what in zip(message.__slots__, message._slot_types, strict=True):
        full = _name_of(message, before, name, what)
        if full in found:
            raise InvalidArgumentError(f"two fields of the goal would be the parameter '{full}'")
        if what in _INTEGERS:
            sign, bits = _INTEGERS[what]
            low = 0 if sign else -(2 ** (bits - 1))
            # Parameters are of 64 bits with a sign.
            high = 2 ** min(bits if sign else bits - 1, 63) - 1
            found[full] = {"type": "int", "default": 0}
            if bits < 64 or sign:
                found[full]["min"] = low
            if bits < 64:
                found[full]["max"] = high
        elif what in _FLOATS:
            found[full] = {"type": "double", "default": 0}
        elif what == "bool":
            found[full] = {"type": "bool", "default": False}
        elif what == "string":
            found[full] = {"type": "string", "default": ""}
        elif what == "time":
            found[full] = {"type": "time", "default": 0}
        elif what == "duration":
            found[full] = {"type": "double", "unit": "s", "default": 0}
        elif what == _HEADER:
            found[full] = {"type": "string", "default": frame}
        elif what in _POSITIONS:
            found[full] = {"type": "position"}
        elif what == _POSE:
            found[full] = {"type": "pose"}
        elif what == _ORIENTATION:
            found[full] = {"type": "numbers", "default": [1, 0, 0, 0], "doc": "w, x, y, z"}
        elif (element := _element_of(what)) is not None:
            if _is_number(element):
                found[full] = {"type": "numbers", "default": [0] * _length_of(what)}
            else:
                found[full] = {"type": "string", "default": "[]", "doc": f"{what} as JSON"}
        else:
            _describe(getattr(message, name), full, frame, found)


def _fill(message: Any, before: str, values: dict[str, Any], now: Any) -> None:
    for name, what in zip(message.__slots__, message._slot_types, strict=True):
        full = _name_of(message, before, name, what)
        field = getattr(message, name)
        if what == _HEADER:
            field.frame_id = str(values[full])
            if now is not None:
                field.stamp = now
        elif what in _POSITIONS:
            field.x, field.y, field.z = (float(one) for one in values[full])
        elif what == _POSE:
            _fill_orientation(field.orientation, full, values[full]["orientation"])
            position = field.position
            position.x, position.y, position.z = (float(one) for one in values[full]["position"])
        elif what == _ORIENTATION:
            _fill_orientation(field, full, values[full])
        elif what in _PLAIN or _element_of(what) is not None:
            setattr(message, name, _native(what, values[full], field, full))
        else:
            _fill(field, full, values, now)


def _fill_orientation(field: Any, name: str, numbers: Any) -> None:
    if len(numbers) != 4:
        raise InvalidArgumentError(f"'{name}': found {len(numbers)} numbers, needs 4: w, x, y, z")
    field.w, field.x, field.y, field.z = (float(one) for one in numbers)


def _native(what: str, value: Any, now: Any, name: str) -> Any:
    """A parameter as ROS takes it. `now`: what the field of the message has, which tells its class."""
    if what in _INTEGERS:
        return int(value)
    if what in _FLOATS:
        return float(value)
    if what == "bool":
        return bool(value)
    if what == "time":
        return type(now)(*divmod(int(value), 10**9))
    if what == "duration":
        return type(now).from_sec(float(value))
    element = _element_of(what)
    if element is None:
        return str(value)
    length = _length_of(what)
    read = list(value) if _is_number(element) else _read_json(value, what, name)
    if length and len(read) != length:
        raise InvalidArgumentError(f"'{name}': found {len(read)} elements, {what} needs {length}")
    if element in ("uint8", "char"):
        return bytes(_small(one, name) for one in read)
    if element in _INTEGERS:
        return [int(one) for one in read]
    if element in _FLOATS:
        return [float(one) for one in read]
    if element == "bool":
        return [bool(one) for one in read]
    if element == "string":
        return [str(one) for one in read]
    return [_from_json(element, one, name) for one in read]


def _small(number: Any, name: str) -> int:
    if not 0 <= number <= 255:
        raise InvalidArgumentError(f"'{name}': found {number}, needs 0 to 255")
    return int(number)


def _is_number(element: str) -> bool:
    return element in _INTEGERS or element in _FLOATS or element == "bool"


def _read_json(text: str, what: str, name: str) -> list[Any]:
    try:
        read = json.loads(text)
    except ValueError as error:
        raise InvalidArgumentError(f"'{name}': {error}; needs {what} as JSON") from error
    if not isinstance(read, list):
        raise InvalidArgumentError(f"'{name}': found {text[:40]!r}, needs a list of {what}")
    return read


def _from_json(kind: str, given: Any, name: str) -> Any:
    """A message of type `kind` in a list. Its fields have the names that ROS has."""
    genpy = needs("genpy", "a list of messages")
    if kind in ("time", "duration"):
        return (genpy.Time if kind == "time" else genpy.Duration).from_sec(float(given))
    found = needs("roslib.message", "a list of messages").get_message_class(kind)
    if found is None:
        raise InvalidArgumentError(f"'{name}': the messages of {kind} are not installed")
    message = found()
    try:
        genpy.message.fill_message_args(message, [given])
    except (genpy.MessageException, ValueError, TypeError) as error:
        raise InvalidArgumentError(f"'{name}': {error}") from error
    return message


def _field_value(field: Any, what: str) -> Value:
    element = _element_of(what)
    if element is None:
        return value_of(field)
    if element in ("uint8", "char"):
        return np.frombuffer(bytes(field), np.uint8)
    if element == "bool":
        return np.array(field, np.uint8)
    if element in _INTEGERS:
        sign, bits = _INTEGERS[element]
        return np.array(field, f"{sign}int{bits}")
    if element in _FLOATS:
        return np.array(field, _FLOATS[element])
    return [value_of(one) for one in field]


def _plain_value(value: Any) -> Value:
    if hasattr(value, "to_nsec"):
        # A time has no sign, and cannot be negated; a duration can.
        is_duration = hasattr(value, "__neg__")
        return np.float64(value.to_sec()) if is_duration else np.int64(value.to_nsec())
    if isinstance(value, (bool, str)):
        return value
    if isinstance(value, bytes):
        return value.decode("utf-8", "surrogateescape")
    if isinstance(value, int):
        # An int64 of IDF holds no more; the number is told nearly rather than not at all.
        return np.int64(value) if value < 2**63 else np.float64(value)
    return np.float64(value)
