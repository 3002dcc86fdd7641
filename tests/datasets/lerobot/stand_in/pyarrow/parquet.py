# SPDX-License-Identifier: Apache-2.0
"""Tables whose files are a JSON object per row; {"hex": "..."} stands for the bytes of an image.

Proves what parquet_to_csv.py does with columns, lists, texts, images and batches once it has them;
nothing of how the real pyarrow reads Parquet.
"""
import json
import types


class Column(list):
    def to_pylist(self):
        return list(self)


class Batch:
    def __init__(self, rows):
        self.rows = rows

    def column(self, name):
        return Column(row.get(name) for row in self.rows)


def value_of(value):
    if isinstance(value, dict) and "hex" in value:
        return {"bytes": bytes.fromhex(value["hex"]), "path": None}
    return value


class ParquetFile:
    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            self.rows = [{name: value_of(value) for name, value in json.loads(line).items()}
                         for line in file]
        names = list(dict.fromkeys(name for row in self.rows for name in row))
        self.schema_arrow = types.SimpleNamespace(names=names)

    def iter_batches(self, batch_size, columns):
        for at in range(0, len(self.rows), batch_size):
            yield Batch([{name: row.get(name) for name in columns}
                         for row in self.rows[at:at + batch_size]])
