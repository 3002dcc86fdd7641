# SPDX-License-Identifier: Apache-2.0
"""The Interpretable Data Format in pure Python and NumPy.

Values, their binary and JSON forms, types, checking and casting, as docs/idf.md and
docs/format.md describe them, and what the classes of `engram idf generate --python` stand on.
"""

from engram.idf import types
from engram.idf.binary import MAX_DEPTH, decode, encode
from engram.idf.cast import CastNote, cast, default_value
from engram.idf.check import Mismatch, check
from engram.idf.errors import IdfError
from engram.idf.json_text import from_json, to_json
from engram.idf.pose import Pose
from engram.idf.type_data import type_from_data
from engram.idf.type_table import type_to_data
from engram.idf.typed import TypedObject, from_value, to_value
from engram.idf.types import Type
from engram.idf.value import Value, at, describe, equal, join_path, kind_name, split_path

__all__ = [
    "MAX_DEPTH",
    "CastNote",
    "IdfError",
    "Mismatch",
    "Pose",
    "Type",
    "TypedObject",
    "Value",
    "at",
    "cast",
    "check",
    "decode",
    "default_value",
    "describe",
    "encode",
    "equal",
    "from_json",
    "from_value",
    "join_path",
    "kind_name",
    "split_path",
    "to_json",
    "to_value",
    "type_from_data",
    "type_to_data",
    "types",
]
