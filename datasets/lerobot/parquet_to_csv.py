# SPDX-License-Identifier: Apache-2.0
"""Writes a Parquet table as CSV: parquet_to_csv.py TABLE.parquet TABLE.csv

Lists of numbers become a column each ("action.0"), lists of anything else JSON; images become files
in TABLE.csv.images. What is missing is an empty cell. Memory: a batch of rows.
"""
import csv
import json
import os
import sys

ROWS = 256


def flat(value):
    if not isinstance(value, (list, tuple)):
        return [value]
    return [number for part in value for number in flat(part)]


def written(number):
    """Numbers as they are read back exactly; bool as 0 or 1."""
    if number is None:
        return ""
    if isinstance(number, (bool, int)):
        return str(int(number))
    return repr(number) if isinstance(number, float) else str(number)


class Numbers:
    def __init__(self, name, sample):
        self.name, self.count = name, len(flat(sample))
        self.is_list = isinstance(sample, (list, tuple))

    def header(self):
        return [f"{self.name}.{i}" for i in range(self.count)] if self.is_list else [self.name]

    def cells(self, value):
        numbers = [None] * self.count if value is None else flat(value)
        if len(numbers) != self.count:
            raise ValueError(f"column '{self.name}': {len(numbers)} numbers, needs {self.count}")
        return [written(number) for number in numbers]


class Text:
    def __init__(self, name):
        self.name = name

    def header(self):
        return [self.name]

    def cells(self, value):
        if value is None or isinstance(value, str):
            return [value or ""]
        return [json.dumps(value, default=str)]


class Image:
    def __init__(self, name, number, folder):
        self.name, self.number, self.folder, self.row = name, number, folder, 0
        os.makedirs(folder, exist_ok=True)

    def header(self):
        return [self.name]

    def cells(self, value):
        self.row += 1
        if value is None or value.get("bytes") is None:
            return [(value or {}).get("path") or ""]
        name = f"{self.number}_{self.row}"
        with open(os.path.join(self.folder, name), "wb") as file:
            file.write(value["bytes"])
        return [os.path.join(os.path.basename(self.folder), name)]


def column_of(name, number, values, folder):
    sample = next((value for value in values if value is not None), None)
    if isinstance(sample, dict) and "bytes" in sample:
        return Image(name, number, folder)
    numbers = flat(sample)
    if all(one is None or isinstance(one, (bool, int, float)) for one in numbers):
        return Numbers(name, sample)
    return Text(name)


def main(source, target):
    try:
        import pyarrow.parquet
    except ImportError:
        print("engram: no pyarrow", flush=True)
        return
    table = pyarrow.parquet.ParquetFile(source)
    # Statistics of episodes are left out: they are larger than all else, and derived from it.
    names = [name for name in table.schema_arrow.names if not name.startswith("stats/")]
    columns = None
    with open(target, "w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        for batch in table.iter_batches(batch_size=ROWS, columns=names):
            values = [batch.column(name).to_pylist() for name in names]
            if columns is None:
                columns = [column_of(name, i, values[i], target + ".images")
                           for i, name in enumerate(names)]
                rows.writerow([cell for column in columns for cell in column.header()])
            for row in zip(*values):
                rows.writerow([cell for column, value in zip(columns, row)
                               for cell in column.cells(value)])
        if columns is None:
            rows.writerow(names)
    print("engram: done", flush=True)


main(sys.argv[1], sys.argv[2])
