# SPDX-License-Identifier: Apache-2.0
"""The JSON form."""

import unittest

import numpy as np
from random_values import RandomValues, nested_dicts, nested_lists

from engram import idf


class Json(unittest.TestCase):
    def assert_refused(self, text, message):
        with self.assertRaisesRegex(idf.IdfError, message):
            idf.from_json(text)

    def test_random_values_survive_the_round_trip(self):
        random = RandomValues(5)
        for _ in range(2500):
            value = random.value(4)
            text = idf.to_json(value)
            read = idf.from_json(text)
            self.assertTrue(idf.equal(value, read), text)
            self.assertEqual(idf.to_json(read), text)

    def test_texts_are_those_of_the_format(self):
        for value, text in (
            (None, "null"),
            (np.int32(5), '{"$int32":5}'),
            (2**53 - 1, "9007199254740991"),
            (2**53, '{"$int64":"9007199254740992"}'),
            (np.int64(-(2**63)), '{"$int64":"-9223372036854775808"}'),
            (np.float32(0.1), '{"$float32":0.10000000149011612}'),
            (float("nan"), '{"$float64":"nan"}'),
            (np.float32("-inf"), '{"$float32":"-inf"}'),
            ({"$a": ["ü\n\x01"]}, '{"$$a":["ü\\n\\u0001"]}'),
            (
                np.array([[1, np.inf]], np.float32),
                '{"$ndarray":{"type":"float32","shape":[1,2],"data":[1.0,"inf"]}}',
            ),
            (
                np.zeros(64, np.int8),
                '{"$ndarray":{"type":"int8","shape":[64],"base64":"' + "A" * 86 + '=="}}',
            ),
        ):
            self.assertEqual(idf.to_json(value), text)
            self.assertTrue(idf.equal(idf.from_json(text), value), text)

    def test_doubles_are_printed_in_the_notation_of_cpp(self):
        for value, text in (
            (0.0, "0.0"),
            (-0.0, "-0.0"),
            (1.0, "1.0"),
            (0.001, "0.001"),
            (0.0001, "0.0001"),
            (0.00001, "1e-05"),
            (1.5e-7, "1.5e-07"),
            (123456789012345.0, "123456789012345.0"),
            (1e15, "1e+15"),
            (1.25e22, "1.25e+22"),
            (5e-324, "5e-324"),
        ):
            self.assertEqual(idf.to_json(value), text)

    def test_numbers_beyond_64_bits_are_floats(self):
        self.assertTrue(idf.equal(idf.from_json("18446744073709551616"), float(2**64)))
        self.assertTrue(idf.equal(idf.from_json("1" + "0" * 300), 1e300))
        self.assert_refused("9223372036854775808", "an integer beyond int64")

    def test_what_is_no_value_is_refused(self):
        for text, message in (
            ("", "no JSON"),
            ("NaN", "found NaN"),
            ("1e999", "exceeds float64"),
            ("1" + "0" * 5000, "exceeds float64"),
            ('"\\ud800"', "lone surrogate"),
            ('{"$int32":1,"a":2}', r"the type tag '\$int32' beside other keys"),
            ('{"a":{"$int32":2147483648}}', r"at '/a': found a \$int32"),
            ('{"$int32":true}', r"\$int32"),
            ('{"$int64":"+1"}', r"\$int64"),
            ('{"$float32":1e39}', r"\$float32"),
            ('{"$float32":"nan:3f800000"}', r"\$float32"),
            ('{"$nothing":1}', r"\$nothing"),
            ('{"$ndarray":{"type":"int8"}}', "without type and shape"),
            ('{"$ndarray":{"type":"bool","shape":[],"data":[1]}}', "unknown element type"),
            ('{"$ndarray":{"type":"int8","shape":[1.5],"data":[1]}}', "not of integers"),
            ('{"$ndarray":{"type":"int8","shape":[-1],"data":[1]}}', "of shape"),
            ('{"$ndarray":{"type":"int8","shape":[2],"data":[1]}}', "1 elements"),
            ('{"$ndarray":{"type":"int8","shape":[1],"data":[128]}}', "does not fit"),
            ('{"$ndarray":{"type":"int8","shape":[1],"base64":"AB=="}}', "broken base64"),
            ('{"$ndarray":{"type":"int16","shape":[1],"base64":"AA=="}}', "1 bytes"),
            ("[" * 65 + "]" * 65, "more than 64 levels"),
            ("[" * 100000, "no JSON"),
        ):
            self.assert_refused(text, message)

    def test_broken_text_is_a_value_or_an_error(self):
        random = RandomValues(6)
        for _ in range(60):
            text = idf.to_json([random.value(3) for _ in range(3)])
            for at in range(len(text)):
                for letter in ("", "}", "9", '"'):
                    try:
                        idf.from_json(text[:at] + letter + text[at + 1 :])
                    except idf.IdfError:
                        pass

    def test_depth_and_utf8_are_checked_on_writing(self):
        for value in (nested_lists(64), nested_dicts(64)):
            self.assertTrue(idf.equal(idf.from_json(idf.to_json(value)), value))
        for value in (nested_lists(65), nested_dicts(65), {"\udcff": 1}, {1: 2}):
            with self.assertRaises(idf.IdfError):
                idf.to_json(value)


if __name__ == "__main__":
    unittest.main()
