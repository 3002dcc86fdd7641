# SPDX-License-Identifier: Apache-2.0
"""Times: int nanoseconds since 1970 (UTC) inside, whatever Python calls a time outside."""

from __future__ import annotations

import datetime
from typing import Union

import numpy as np

from engram.errors import InvalidArgumentError

TimeLike = Union[int, np.integer, np.datetime64, datetime.datetime, str]
DurationLike = Union[int, float, np.timedelta64, datetime.timedelta]

_NS_PER_SECOND = 1_000_000_000


def to_ns(time: TimeLike) -> int:
    """Nanoseconds since 1970. An int is that already; a str is ISO 8601, without a zone UTC.

    Raises InvalidArgumentError for what is no time: a float would be, but loses 100 ns.
    """
    if isinstance(time, (bool, np.bool_)):
        raise InvalidArgumentError(f"time {time!r}: needs nanoseconds, a datetime or a text")
    if isinstance(time, (int, np.integer)):
        return int(time)
    if isinstance(time, datetime.datetime):
        since = _utc(time) - datetime.datetime(1970, 1, 1, tzinfo=datetime.timezone.utc)
        return (since.days * 86_400 + since.seconds) * _NS_PER_SECOND + since.microseconds * 1000
    if isinstance(time, str):
        return to_ns(_parsed(time))
    if isinstance(time, np.datetime64) and not np.isnat(time):
        return int(time.astype("datetime64[ns]").astype(np.int64))
    raise InvalidArgumentError(f"time {time!r}: needs nanoseconds, a datetime or a text")


def duration_ns(duration: DurationLike) -> int:
    """Nanoseconds of a duration; a plain number is seconds."""
    if isinstance(duration, np.timedelta64):
        return int(duration.astype("timedelta64[ns]").astype(np.int64))
    if isinstance(duration, datetime.timedelta):
        return round(duration.total_seconds() * _NS_PER_SECOND)
    return round(duration * _NS_PER_SECOND)


def to_datetime64(time_ns: int) -> np.datetime64:
    """A time for NumPy and pandas, exact to the nanosecond."""
    return np.datetime64(time_ns, "ns")


def _utc(time: datetime.datetime) -> datetime.datetime:
    return time.replace(tzinfo=datetime.timezone.utc) if time.tzinfo is None else time


def _parsed(text: str) -> np.datetime64:
    try:
        return np.datetime64(text.strip().removesuffix("Z").replace(" ", "T"), "ns")
    except ValueError as error:
        raise InvalidArgumentError(f"time '{text}': {error}") from None
