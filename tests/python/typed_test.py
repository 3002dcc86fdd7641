# SPDX-License-Identifier: Apache-2.0
"""What generated classes stand on, without generated ones, and poses."""

import unittest

import numpy as np

from engram import idf
from engram.idf import types


class ToValue(unittest.TestCase):
    def test_numbers_are_of_the_kind_that_the_type_says(self):
        for given, of, value in (
            (5, types.Int(), np.int32(5)),
            (5, types.Long(), np.int64(5)),
            (5, types.Double(), np.float64(5)),
            (0.1, types.Float(), np.float32(0.1)),
            (np.uint8(7), types.Time(), np.int64(7)),
        ):
            self.assertTrue(idf.equal(idf.to_value(given, of), value), of)

    def test_what_would_be_changed_is_refused_with_its_path(self):
        of = types.Dict(element=types.Int())
        for given in (2**31, 0.5, True, "5", None, 2**80):
            with self.assertRaisesRegex(idf.IdfError, "'a': found .*, needs int32"):
                idf.to_value({"a": given}, of)
        with self.assertRaisesRegex(idf.IdfError, "needs float32"):
            idf.to_value(1e39, types.Float())

    def test_arrays_are_not_copied_unless_they_must_be(self):
        image = np.zeros((4, 6, 3), np.uint8)
        of = types.Image(pixel="rgb24")
        self.assertTrue(np.shares_memory(idf.to_value(image, of), image))
        self.assertTrue(np.shares_memory(idf.from_value(image, of), image))
        turned = idf.to_value(image[:, ::-1], of)
        self.assertTrue(turned.flags.c_contiguous)
        with self.assertRaisesRegex(idf.IdfError, r"needs ndarray uint8 \[\*, \*, 3\]"):
            idf.to_value(image[..., 0], of)
        with self.assertRaisesRegex(idf.IdfError, "needs ndarray uint8"):
            idf.to_value(image - np.float64(1), of)
        self.assertEqual(idf.to_value([1, 2], types.NDArray(shape=(-1,))).dtype, np.float32)


class FromValue(unittest.TestCase):
    def test_numbers_become_plain_ones(self):
        read = idf.from_value([np.int32(3)], types.List(element=types.Int()))
        self.assertIs(type(read[0]), int)
        self.assertIs(type(idf.from_value(np.float32(0.5), types.Float())), float)

    def test_wider_types_read_narrower_values(self):
        self.assertEqual(idf.from_value(np.int32(3), types.Long()), 3)
        with self.assertRaisesRegex(idf.IdfError, "narrowed"):
            idf.from_value(np.float64(0.1), types.Float())

    def test_bounds_are_not_checked(self):
        self.assertEqual(idf.from_value(np.int32(9), types.Int(maximum=3)), 9)

    def test_values_without_a_class_are_dicts_and_numbers(self):
        color = types.IntEnum(name="C", values=(types.EnumValue("RED", 1),))
        of = types.Object(name="O", members=(types.Member("c", color),))
        self.assertEqual(idf.from_value({"c": np.int32(1), "more": 2}, of), {"c": 1})
        with self.assertRaisesRegex(idf.IdfError, "'c': found int32 2"):
            idf.from_value({"c": np.int32(2)}, of)


class Pose(unittest.TestCase):
    def test_a_matrix_and_back_is_the_same_pose(self):
        random = np.random.default_rng(7)
        for _ in range(200):
            turn = random.normal(size=4)
            turn /= np.linalg.norm(turn) * (1 if turn[0] >= 0 else -1)
            pose = idf.Pose(random.normal(size=3), turn)
            made = idf.Pose.from_matrix(pose.matrix(), np.float64)
            np.testing.assert_allclose(made.position, pose.position, atol=1e-12)
            np.testing.assert_allclose(made.orientation, pose.orientation, atol=1e-9)

    def test_a_quarter_turn_about_z_takes_x_to_y(self):
        pose = idf.Pose(np.array([1.0, 2, 3]), np.array([np.sqrt(0.5), 0, 0, np.sqrt(0.5)]))
        np.testing.assert_allclose(pose.matrix() @ [1, 0, 0, 1], [1, 3, 3, 1], atol=1e-12)

    def test_half_turns_have_a_quaternion(self):
        for axis in range(3):
            diagonal = -np.ones(4)
            diagonal[[axis, 3]] = 1
            turn = idf.Pose.from_matrix(np.diag(diagonal)).orientation
            np.testing.assert_allclose(np.abs(turn), np.eye(4)[axis + 1], atol=1e-6)

    def test_what_is_no_rotation_is_refused(self):
        for matrix in (np.eye(3), 2 * np.eye(4), np.diag([1, 1, -1, 1]), np.ones((4, 4))):
            with self.assertRaises(idf.IdfError):
                idf.Pose.from_matrix(matrix)

    def test_equality_is_bitwise(self):
        self.assertEqual(idf.Pose(), idf.Pose())
        self.assertNotEqual(idf.Pose(), idf.Pose.identity(np.float64))


if __name__ == "__main__":
    unittest.main()
