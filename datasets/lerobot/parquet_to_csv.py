# SPDX-License-Identifier: Apache-2.0
"""Writes the numbers of a Parquet table as CSV: parquet_to_csv.py TABLE.parquet TABLE.csv"""
import sys


def main(source, target):
    try:
        import pyarrow.parquet
    except ImportError:
        print("engram: no pyarrow", flush=True)
        return
    table = pyarrow.parquet.read_table(source)
    columns = []
    for name in table.column_names:
        values = table.column(name).to_pylist()
        if values and isinstance(values[0], list):
            columns += [(f"{name}.{i}", [row[i] for row in values]) for i in range(len(values[0]))]
        elif not values or isinstance(values[0], (bool, int, float)):
            columns.append((name, values))
    with open(target, "w", encoding="utf-8") as file:
        file.write(",".join(name for name, _ in columns) + "\n")
        for row in zip(*(values for _, values in columns)):
            file.write(",".join(repr(float(value)) for value in row) + "\n")
    print("engram: done", flush=True)


main(sys.argv[1], sys.argv[2])
