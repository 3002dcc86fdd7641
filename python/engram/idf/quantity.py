# SPDX-License-Identifier: Apache-2.0
"""Bounds of numbers, exact for every element type."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from engram.idf.types import Quantity


def is_within(quantity: Quantity, numbers: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """Which of the numbers are within the bounds."""
    within = np.ones(numbers.shape, np.bool_)
    if not quantity.is_bounded:
        return within
    low, high = quantity.minimum, quantity.maximum
    if numbers.dtype.kind == "f":
        within &= np.isfinite(numbers)
        wide = numbers.astype(np.float64)
        within &= wide >= (-math.inf if low is None else low)
        within &= wide <= (math.inf if high is None else high)
        return within
    # As whole numbers of the same type: 64 bits do not fit into a double.
    limits = np.iinfo(numbers.dtype)
    min_value = int(limits.min) if low is None else math.ceil(low)
    max_value = int(limits.max) if high is None else math.floor(high)
    if min_value > limits.max or max_value < limits.min:
        return np.zeros(numbers.shape, np.bool_)
    first = numbers.dtype.type(max(min_value, int(limits.min)))
    last = numbers.dtype.type(min(max_value, int(limits.max)))
    within &= numbers >= first
    within &= numbers <= last
    return within


def closest_to_zero(quantity: Quantity, dtype: np.dtype[Any]) -> Any:
    """The number within the bounds that is closest to zero; None where there is none."""
    zero = dtype.type(0)
    if _holds(quantity, zero):
        return zero
    low, high = quantity.minimum, quantity.maximum
    is_above = low is not None and low > 0
    bound = low if is_above else high
    if bound is None:
        return None
    if dtype.kind != "f":
        whole = math.ceil(bound) if is_above else math.floor(bound)
        limits = np.iinfo(dtype)
        value = dtype.type(whole) if limits.min <= whole <= limits.max else None
    elif abs(bound) > float(np.finfo(dtype).max):
        value = None
    else:
        value = dtype.type(bound)
        if not _holds(quantity, value):
            value = np.nextafter(value, dtype.type(math.inf if is_above else -math.inf))
    return value if value is not None and _holds(quantity, value) else None


def _holds(quantity: Quantity, number: Any) -> bool:
    return bool(is_within(quantity, np.asarray(number)))
