# SPDX-License-Identifier: Apache-2.0
"""Made-up values of every kind; the same seed gives the same values."""

import random

import numpy as np

from engram.idf.value import ELEMENT_NAMES

PARTS = ["a", "Z", "7", "/", "\\", "ü", "机", '"', "$", ".", " ", "\n", "\x00", "😀"]
KEYS = ["", "$", "$int32", "a/b", "\\", "\\e", ".", "größe"]


class RandomValues:
    def __init__(self, seed):
        self.random = random.Random(seed)

    def text(self):
        return "".join(self.random.choices(PARTS, k=self.random.randrange(9)))

    def key(self):
        return self.random.choice(KEYS) if self.random.randrange(4) == 0 else "k" + self.text()

    def scalar(self, dtype):
        return np.frombuffer(self.random.randbytes(np.dtype(dtype).itemsize), dtype)[0]

    def array(self):
        """Row-major or not."""
        shape = [self.random.randrange(5) for _ in range(self.random.randrange(4))]
        dtype = np.dtype(self.random.choice(ELEMENT_NAMES))
        data = self.random.randbytes(int(np.prod(shape)) * dtype.itemsize)
        array = np.frombuffer(data, dtype).reshape(shape)
        return array.T if self.random.randrange(3) == 0 else array

    def value(self, depth):
        kind = self.random.randrange(10 if depth > 0 else 8)
        if kind == 8:
            return [self.value(depth - 1) for _ in range(self.random.randrange(5))]
        if kind == 9:
            count = self.random.randrange(6)
            return {self.key(): self.value(depth - 1) for _ in range(count)}
        makers = [
            lambda: None,
            lambda: self.random.randrange(2) == 0,
            lambda: self.scalar("<i4"),
            lambda: self.scalar("<i8"),
            lambda: self.scalar("<f4"),
            lambda: self.scalar("<f8"),
            self.text,
            self.array,
        ]
        return makers[kind]()


def nested_lists(depth):
    value = np.int32(7)
    for _ in range(depth):
        value = [value]
    return value


def nested_dicts(depth):
    value = np.int32(7)
    for _ in range(depth):
        value = {"inner": value}
    return value
