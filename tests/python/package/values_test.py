# SPDX-License-Identifier: Apache-2.0
"""Values go into the C++ side and come back bit by bit."""

from __future__ import annotations

import gc
import math
import weakref
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from engram import _core, errors, idf
from engram.idf.value import ELEMENT_NAMES

ELEMENTS = st.sampled_from([np.dtype(name) for name in ELEMENT_NAMES])
SHAPES = npst.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=5)
ARRAYS = ELEMENTS.flatmap(lambda dtype: npst.arrays(dtype, SHAPES))
TEXTS = st.text(st.characters(blacklist_categories=("Cs",)), max_size=20)
SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**63), 2**63 - 1),
    st.floats(allow_nan=True),
    TEXTS,
    st.integers(-(2**31), 2**31 - 1).map(np.int32),
    st.integers(-(2**63), 2**63 - 1).map(np.int64),
    st.floats(width=32).map(np.float32),
    st.floats().map(np.float64),
)
VALUES = st.recursive(
    st.one_of(SCALARS, ARRAYS),
    lambda inner: st.one_of(
        st.lists(inner, max_size=4), st.dictionaries(TEXTS, inner, max_size=4)
    ),
    max_leaves=12,
)


@settings(max_examples=300, deadline=None)
@given(VALUES)
def test_values_come_back_bit_by_bit(value: Any) -> None:
    assert idf.equal(_core.round_trip(value), value)


@settings(max_examples=100, deadline=None)
@given(VALUES)
def test_kinds_come_back_as_the_package_names_them(value: Any) -> None:
    assert idf.encode(_core.round_trip(value)) == idf.encode(value)


@settings(max_examples=100, deadline=None)
@given(npst.arrays(np.uint8, (4, 6, 3)), st.data())
def test_arrays_of_any_order_and_endianness_are_taken(image: np.ndarray, data: Any) -> None:
    axes = data.draw(st.permutations(range(3)))
    np.testing.assert_array_equal(_core.round_trip(image.transpose(axes)), image.transpose(axes))
    np.testing.assert_array_equal(_core.round_trip(image[::-1, ::2]), image[::-1, ::2])
    big = image.astype(">i4")
    back = _core.round_trip(big)
    assert back.dtype == np.dtype("int32")
    np.testing.assert_array_equal(back, big)


@pytest.mark.parametrize(
    "value, named",
    [
        ({1, 2}, "set"),
        ({"a": [1, object()]}, "'a/1'"),
        ({"a": {3: 4}}, "'a'"),
        (1 + 2j, "complex"),
        (2**63, "64 bits"),
        (b"bytes", "bytes"),
        (np.uint8(3), "uint8"),
        (np.zeros(3, complex), "complex128"),
        (np.zeros(3, bool), "bool"),
        (np.array(["a"]), "<U1"),
        (np.array([object()]), "object"),
        (np.zeros(2, np.float16), "float16"),
    ],
)
def test_what_is_no_value_is_refused_and_named(value: Any, named: str) -> None:
    with pytest.raises(errors.InvalidArgumentError, match=named):
        _core.round_trip(value)


def test_what_contains_itself_is_refused() -> None:
    value: list[Any] = []
    value.append(value)
    with pytest.raises(errors.InvalidArgumentError, match="deeper"):
        _core.round_trip(value)


def test_objects_of_generated_classes_are_values() -> None:
    class Cup:
        def to_idf(self) -> dict[str, Any]:
            return {"height": np.float64(0.11), "handles": np.int32(1)}

    back = _core.round_trip({"cup": Cup()})
    assert idf.equal(back, {"cup": {"height": np.float64(0.11), "handles": np.int32(1)}})


def test_an_exception_of_to_idf_comes_through() -> None:
    class Broken:
        def to_idf(self) -> None:
            raise ZeroDivisionError("no cup")

    with pytest.raises(ZeroDivisionError, match="no cup"):
        _core.round_trip([Broken()])


def test_texts_that_are_no_utf8_survive() -> None:
    text = b"caf\xe9".decode("utf-8", "surrogateescape")
    assert _core.round_trip(text) == text
    assert _core.round_trip({text: "\x00end"}) == {text: "\x00end"}


def test_arrays_that_come_back_cannot_be_written_and_keep_their_memory() -> None:
    array = _core.round_trip({"a": np.arange(1000.0)})["a"]
    part = array[10:20:2]
    assert not array.flags.writeable and not array.flags.owndata
    owner = weakref.ref(array)
    del array
    gc.collect()
    assert owner() is not None, "the part keeps the whole"
    np.testing.assert_array_equal(part, np.arange(10.0, 20.0, 2.0))


def test_nothing_is_kept_of_what_was_given() -> None:
    class Kept(np.ndarray):
        pass

    array = np.zeros(1000).view(Kept)
    alive = weakref.ref(array)
    _core.round_trip([array])
    del array
    gc.collect()
    assert alive() is None


def test_nan_keeps_its_bits() -> None:
    odd = np.array([0x7FF8000000000123], np.uint64).view(np.float64)
    assert _core.round_trip(odd).tobytes() == odd.tobytes()
    assert math.isnan(_core.round_trip(float("nan")))
