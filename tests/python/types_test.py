# SPDX-License-Identifier: Apache-2.0
"""Stored types, checking and casting; agreement_test has what C++ says to made-up ones."""

import unittest

import numpy as np

from engram import idf
from engram.idf import types


def stored(*entries):
    return {"idf_type": np.int32(1), "types": list(entries)}


INT = {"kind": "Int", "unit": "m", "minimum": 0.0, "maximum": 5.0}
CUP = {
    "kind": "Object",
    "name": "Cup",
    "members": [{"name": "height", "type": np.int32(0), "doc": "Of it."}],
}


class Stored(unittest.TestCase):
    def test_a_type_is_read(self):
        cup = types.Object(
            name="Cup",
            members=(types.Member("height", types.Int(unit="m", minimum=0, maximum=5), "Of it."),),
        )
        self.assertEqual(idf.type_from_data(stored(INT, CUP)), cup)

    def test_64_levels_are_allowed(self):
        def nested(levels):
            dicts = [{"kind": "Dict", "element": np.int32(i)} for i in range(levels)]
            return stored({"kind": "Pose", "element": "float32"}, *dicts)

        self.assertIsInstance(idf.type_from_data(nested(62)), types.Dict)
        with self.assertRaisesRegex(idf.IdfError, "65 levels"):
            idf.type_from_data(nested(63))

    def test_hostile_tables_are_refused(self):
        deep = [INT] + [{"kind": "Dict", "element": np.int32(i)} for i in range(64)]
        wide = [INT] + [{"kind": "Tuple", "elements": [np.int32(i)] * 40} for i in range(4)]
        large = {"kind": "Image", "pixel": "rgb24", "height": np.int64(2**20)}
        for value, message in (
            (None, "found none, needs a dict"),
            ({"idf_type": np.int32(2), "types": []}, "version is not 1"),
            (stored(), "the table is empty"),
            (stored(CUP), "entry 0: 'type': found int32, needs the int32 index of an entry before"),
            (stored({"kind": "What"}), "'kind': 'What' is not known"),
            (stored({"kind": np.int32(1)}), "'kind': found int32, needs string"),
            (stored(*deep), "levels"),
            (stored(*wide), "nodes"),
            (stored({**large, "width": np.int64(2**20)}), "bytes of arrays"),
            (stored({**large, "width": np.int64(-2)}), "size -2"),
            (stored({**INT, "minimum": 6.0}), "no int32 lies within the bounds"),
            (stored({**INT, "minimum": float("nan")}), "a bound is not finite"),
            (stored({"kind": "IntEnum", "name": "E", "values": []}), "has no value"),
            (stored(INT, {**CUP, "members": CUP["members"] * 2}), "'height' is there twice"),
            (stored(INT, {**CUP, "base": np.int32(0)}), "extends Int"),
        ):
            with self.assertRaisesRegex(idf.IdfError, message):
                idf.type_from_data(value)


class Check(unittest.TestCase):
    def test_every_mismatch_is_told_with_its_path(self):
        cup = idf.type_from_data(stored(INT, CUP))
        self.assertEqual(idf.check({"height": np.int32(5)}, cup), [])
        found = idf.check({"height": np.int32(6), "x": None}, types.Dict(element=types.Long()))
        self.assertEqual(
            [str(one) for one in found],
            [
                "'height': found int32 6, needs int64",
                "'x': found none, needs int64",
            ],
        )
        found = idf.check({"height": np.int32(6)}, cup)
        self.assertEqual(str(found[0]), "'height': found int32 6, needs 0..5")

    def test_bounds_of_64_bits_are_exact(self):
        bounded = types.Long(maximum=float(2**62))
        self.assertEqual(idf.check(np.int64(2**62), bounded), [])
        self.assertEqual(len(idf.check(np.int64(2**62 + 1), bounded)), 1)

    def test_an_array_is_reported_once(self):
        array = np.array([0, 7, np.nan], np.float32)
        found = idf.check(array, types.NDArray(shape=(-1,), maximum=5))
        self.assertEqual(
            str(found[0]),
            "'': found 2 of 3 elements out of bounds, first element 1 = 7, needs ..5",
        )


class Cast(unittest.TestCase):
    def test_widening_is_silent_and_rounding_is_noted(self):
        value, notes = idf.cast(np.int32(3), types.Double())
        self.assertTrue(idf.equal(value, np.float64(3)))
        self.assertEqual(notes, [])
        value, notes = idf.cast(np.float64(0.1), types.Float())
        self.assertTrue(idf.equal(value, np.float32(0.1)))
        self.assertEqual([note.kind for note in notes], ["narrowed"])
        for huge in (np.int64(2**63 - 1), np.array([2**64 - 1], np.uint64)):
            of = types.Double() if huge.ndim == 0 else types.NDArray(element="float64", shape=(1,))
            self.assertEqual([note.kind for note in idf.cast(huge, of)[1]], ["narrowed"])

    def test_defaults_of_what_does_not_fit_share_their_arrays(self):
        large = types.Image(pixel="rgb24", height=4000, width=4000)
        made, notes = idf.cast([None] * 10000, types.List(element=large))
        self.assertEqual(len(notes), 10000)
        self.assertTrue(np.shares_memory(made[0], made[-1]))
        self.assertFalse(made[0].flags.writeable)

    def test_what_has_no_place_becomes_the_default(self):
        for value in (np.int64(2**31), 0.5, True, "5", float("nan")):
            made, notes = idf.cast(value, types.Int(minimum=3))
            self.assertTrue(idf.equal(made, np.int32(3)), value)
            self.assertEqual([note.kind for note in notes], ["mismatch"])


if __name__ == "__main__":
    unittest.main()
