# SPDX-License-Identifier: Apache-2.0
"""The binary form, and what values are."""

import unittest

import numpy as np
from random_values import RandomValues, nested_dicts, nested_lists

from engram import idf

MAGIC = b"IDF\x01"


class Encoding(unittest.TestCase):
    def test_random_values_survive_the_round_trip(self):
        random = RandomValues(1)
        for _ in range(2500):
            value = random.value(4)
            data = idf.encode(value)
            read = idf.decode(data)
            self.assertTrue(idf.equal(value, read), value)
            self.assertEqual(idf.encode(read), data)

    def test_bytes_are_those_of_the_format(self):
        value = {"a": np.int32(-2), "b": [None, True, "ü"], "c": np.array([[1, 2]], np.uint16)}
        expected = (
            MAGIC
            + b"\x0a\x03\x01a\x03\xfe\xff\xff\xff\x01b\x09\x03\x00\x02\x07\x02\xc3\xbc"
            + b"\x01c\x08\x06\x02\x01\x02\x00\x00\x01\x00\x02\x00"
        )
        self.assertEqual(idf.encode(value).hex(" "), expected.hex(" "))

    def test_plain_numbers_are_taken_as_64_bits(self):
        self.assertTrue(idf.equal(idf.decode(idf.encode(5)), np.int64(5)))
        self.assertTrue(idf.equal(idf.decode(idf.encode(0.5)), np.float64(0.5)))
        self.assertIs(idf.decode(idf.encode(np.True_)), True)
        self.assertEqual(idf.decode(idf.encode((1, "a"))), [1, "a"])

    def test_nan_keeps_its_bits(self):
        for bits in (0x7F800001, 0xFFC00007, 0x7FC00000):
            nan = np.array([bits], "<u4").view("<f4")[0]
            self.assertEqual(idf.encode(nan)[5:], bits.to_bytes(4, "little"))
            self.assertEqual(idf.encode(idf.decode(idf.encode(nan))), idf.encode(nan))

    def test_arrays_of_any_memory_order_are_written_row_major(self):
        array = np.arange(24, dtype=np.int32).reshape(2, 3, 4)
        for given in (array.T, array[:, ::-1], array[:, 1], array.astype(">i4"), array[::2]):
            read = idf.decode(idf.encode(given))
            self.assertTrue(np.array_equal(read, given))
            self.assertTrue(read.flags.c_contiguous)

    def test_text_that_is_no_utf8_comes_back_as_it_was(self):
        data = MAGIC + b"\x07\x03a\xff\xfe"
        self.assertEqual(idf.encode(idf.decode(data)), data)

    def test_what_is_no_value_is_refused(self):
        for value in (
            {1: 2},
            2**63,
            -(2**63) - 1,
            b"bytes",
            1j,
            np.uint8(3),
            np.float16(3),
            np.timedelta64(3, "ns"),
            np.array([True]),
            np.array(["a"]),
            np.zeros((1,) * 17),
            "\ud800",
            nested_lists(65),
            nested_dicts(65),
        ):
            with self.assertRaises(idf.IdfError):
                idf.encode(value)

    def test_64_levels_are_allowed(self):
        for value in (nested_lists(64), nested_dicts(64)):
            self.assertTrue(idf.equal(idf.decode(idf.encode(value)), value))


class Decoding(unittest.TestCase):
    def test_arrays_are_read_only_views_into_the_bytes(self):
        image = np.arange(48, dtype=np.uint8).reshape(4, 4, 3)
        data = bytearray(idf.encode({"image": image, "n": np.zeros(3)}))
        read = idf.decode(memoryview(data))
        self.assertTrue(np.shares_memory(read["image"], np.frombuffer(data, np.uint8)))
        self.assertTrue(np.shares_memory(read["n"], np.frombuffer(data, np.uint8)))
        self.assertFalse(read["image"].flags.writeable)

    def test_arrays_at_odd_addresses_are_copied_to_even_ones(self):
        data = memoryview(b"x" + idf.encode(np.arange(3.0)))[1:]
        self.assertTrue(idf.decode(data).flags.aligned)
        self.assertEqual(idf.decode(data).tolist(), [0, 1, 2])

    def test_every_prefix_is_refused(self):
        random = RandomValues(2)
        for _ in range(60):
            data = idf.encode([random.value(3) for _ in range(4)])
            for end in range(len(data)):
                with self.assertRaises(idf.IdfError):
                    idf.decode(data[:end])

    def test_changed_bytes_are_a_value_or_an_error(self):
        random = RandomValues(3)
        errors = 0
        for _ in range(40):
            data = idf.encode([random.value(3) for _ in range(4)])
            for at in range(len(data)):
                for byte in (data[at] ^ 0x80, data[at] ^ 1, 0xFF, 0x0A):
                    changed = data[:at] + bytes((byte,)) + data[at + 1 :]
                    try:
                        idf.encode(idf.decode(changed))
                    except idf.IdfError:
                        errors += 1
        self.assertGreater(errors, 1000)

    def assert_refused(self, data, message):
        with self.assertRaisesRegex(idf.IdfError, message):
            idf.decode(data)

    def test_errors_name_offset_and_what_was_found(self):
        self.assert_refused(b"", "needs the header 'IDF' and version 1, found 0 other")
        self.assert_refused(b"IDF\x02\x00", "version 1")
        self.assert_refused(MAGIC, "offset 4: the bytes end where a value must start")
        self.assert_refused(MAGIC + b"\x0b", "offset 4: unknown tag 11")
        self.assert_refused(MAGIC + b"\x00\x00", "1 bytes after the value at offset 5")
        self.assert_refused(MAGIC + b"\x03\x00", "offset 5: the bytes end inside a number")
        self.assert_refused(MAGIC + b"\x09\xff\xff\x7f", "2097151 elements announced, 0 bytes left")
        self.assert_refused(MAGIC + b"\x09" + b"\xff" * 10, "a length exceeds 64 bits")
        self.assert_refused(MAGIC + b"\x09" + b"\xff" * 9 + b"\x02", "a length exceeds 64 bits")
        self.assert_refused(MAGIC + b"\x0a\x02\x01a\x00\x01a\x00", "the key 'a' twice")
        self.assert_refused(MAGIC + b"\x09\x01" * 65 + b"\x00", "nests too deep")
        self.assert_refused(MAGIC + b"\x08\x0b\x00", "an ndarray of unknown type or rank above 16")
        self.assert_refused(MAGIC + b"\x08\x05\x11" + b"\x01" * 17, "rank above 16")

    def test_huge_arrays_are_refused_before_they_are_made(self):
        axis = b"\xff\xff\xff\xff\xff\xff\xff\xff\x7f"  # 2^63 - 1
        self.assert_refused(MAGIC + b"\x08\x0a\x01" + axis, "exceeds the 0 bytes left")
        self.assert_refused(MAGIC + b"\x08\x0a\x04" + axis * 4, "exceeds the 0 bytes left")
        beyond = b"\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"
        self.assert_refused(MAGIC + b"\x08\x0a\x01" + beyond, "exceeds 63 bits")
        empty = MAGIC + b"\x08\x0a\x04" + axis * 3 + b"\x00" + b"\x00" * 8
        with self.assertRaises(idf.IdfError):  # NumPy cannot count it.
            idf.decode(empty)


class Values(unittest.TestCase):
    def test_equality_is_bitwise_and_of_kinds(self):
        self.assertFalse(idf.equal(np.int32(5), np.int64(5)))
        self.assertFalse(idf.equal(np.float32(0.5), np.float64(0.5)))
        self.assertFalse(idf.equal(0.0, -0.0))
        self.assertFalse(idf.equal(True, np.int64(1)))
        self.assertFalse(idf.equal({"a": 1, "b": 1}, {"b": 1, "a": 1}))
        self.assertFalse(idf.equal(np.zeros(3), np.zeros((3, 1))))
        self.assertFalse(idf.equal(np.zeros(3), np.zeros(3, np.int64)))
        self.assertTrue(idf.equal({"a": [np.float32("nan")]}, {"a": [np.float32("nan")]}))
        self.assertFalse(idf.equal(np.array([0.0]), np.array([-0.0])))

    def test_paths_reach_every_part(self):
        value = {"a/b": [1, {"": "x", "\\": "y"}], "n": None}
        self.assertEqual(idf.at(value, "a\\/b/1/\\e"), "x")
        self.assertEqual(idf.at(value, "a\\/b/1/\\\\"), "y")
        self.assertIsNone(idf.at(value, "n"))
        self.assertIs(idf.at(value, ""), value)
        for path in ("b", "a\\/b/2", "a\\/b/-1", "a\\/b/x", "n/x"):
            with self.assertRaisesRegex(idf.IdfError, "found nothing"):
                idf.at(value, path)
        random = RandomValues(4)
        for _ in range(200):
            names = [random.key() for _ in range(3)]
            path = ""
            for name in names:
                path = idf.join_path(path, name)
            self.assertEqual(idf.split_path(path), names)


if __name__ == "__main__":
    unittest.main()
