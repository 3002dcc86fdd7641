# SPDX-License-Identifier: Apache-2.0
"""Numbers of snapshots as tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from engram.idf.value import join_path
from engram.optional import needs
from engram.snapshot import Snapshot

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import]

#: Larger arrays, such as images, and longer lists are no columns.
MAX_COLUMNS_OF_A_MEMBER = 1024


def frame_of(snapshots: Iterable[Snapshot]) -> pd.DataFrame:
    """A row per snapshot, indexed by its time (UTC); a column per number, bool and text.

    Members of arrays are columns by their place, "position/0"; arrays of more than 1,024 elements
    are left out. Columns come in the order of their first appearance, and are empty where a
    snapshot has none.
    """
    pandas = needs("pandas", "a DataFrame")
    # Snapshots of one layout are columns at once.
    tables: dict[tuple[Any, ...], _Table] = {}
    for snapshot in snapshots:
        leaves = list(_leaves(snapshot.value, ""))
        layout = tuple((path, np.shape(leaf), type(leaf)) for path, leaf in leaves)
        tables.setdefault(layout, _Table()).add(snapshot.time, leaves)
    frames = [table.to_frame(pandas) for table in tables.values()]
    if len(frames) > 1:
        return pandas.concat(frames).sort_index(kind="stable")
    return frames[0] if frames else _Table().to_frame(pandas)


def numbers_of(value: Any) -> list[Any]:
    """All numbers and bools of a value, in the order of its columns."""
    return [
        number
        for _, leaf in _leaves(value, "")
        if not isinstance(leaf, str)
        for number in np.ravel(leaf)
    ]


class _Table:
    """Values that have the same members."""

    def __init__(self) -> None:
        self._times: list[int] = []
        self._paths: list[str] = []
        self._columns: list[list[Any]] = []

    def add(self, time: int, leaves: list[tuple[str, Any]]) -> None:
        if not self._times:
            self._paths = [path for path, _ in leaves]
            self._columns = [[] for _ in leaves]
        self._times.append(time)
        for column, (_, leaf) in zip(self._columns, leaves):
            column.append(leaf)

    def to_frame(self, pandas: Any) -> Any:
        times = np.asarray(self._times, np.int64).astype("datetime64[ns]")
        index = pandas.DatetimeIndex(times, tz="UTC", name="time")
        columns: dict[str, Any] = {}
        for path, values in zip(self._paths, self._columns):
            if not isinstance(values[0], np.ndarray):
                columns[path or "value"] = values
                continue
            stacked = np.stack(values)
            for place in np.ndindex(stacked.shape[1:]):
                name = "/".join(filter(None, (path, *map(str, place)))) or "value"
                columns[name] = stacked[(slice(None), *place)]
        return pandas.DataFrame(columns, index=index)


def _leaves(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, each in value.items():
            yield from _leaves(each, join_path(path, key))
    elif isinstance(value, list):
        if len(value) <= MAX_COLUMNS_OF_A_MEMBER:
            for i, each in enumerate(value):
                yield from _leaves(each, join_path(path, i))
    elif value is not None and np.size(value) <= MAX_COLUMNS_OF_A_MEMBER:
        yield path, value
