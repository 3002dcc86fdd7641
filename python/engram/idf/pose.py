# SPDX-License-Identifier: Apache-2.0
"""Where something is and how it is turned."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from engram.idf.errors import IdfError
from engram.idf.value import equal


@dataclass(eq=False)
class Pose:
    """A position and an orientation, both float32 or both float64.

    Frame: `pose_world_camera` takes camera coordinates to world:
    p_world = orientation * p_camera + position. Orientations are Hamilton quaternions of norm 1.
    """

    position: npt.NDArray[Any] = field(default_factory=lambda: np.zeros(3, np.float32))
    """Unit: m. Shape: [3]."""
    orientation: npt.NDArray[Any] = field(
        default_factory=lambda: np.array([1, 0, 0, 0], np.float32)
    )
    """w, x, y, z. Shape: [4]."""

    @classmethod
    def identity(cls, dtype: npt.DTypeLike = np.float32) -> Self:
        """The pose that changes nothing."""
        return cls(np.zeros(3, dtype), np.array([1, 0, 0, 0], dtype))

    @classmethod
    def from_matrix(cls, matrix: npt.ArrayLike, dtype: npt.DTypeLike = np.float32) -> Self:
        """The pose of a homogeneous matrix [4, 4]: rotation and translation, last row 0 0 0 1.

        Raises IdfError where the shape is another or the upper left is no rotation within 0.001.
        """
        given = np.asarray(matrix, np.float64)
        if given.shape != (4, 4):
            raise IdfError(f"pose: found a matrix {list(given.shape)}, needs [4, 4]")
        turn = given[:3, :3]
        is_rotation = np.allclose(turn @ turn.T, np.eye(3), atol=1e-3) and np.linalg.det(turn) > 0
        if not is_rotation or not np.allclose(given[3], [0, 0, 0, 1], atol=1e-3):
            raise IdfError("pose: found a matrix that is no rotation with a translation")
        return cls(given[:3, 3].astype(dtype), _quaternion(turn).astype(dtype))

    def matrix(self) -> npt.NDArray[np.float64]:
        """The homogeneous matrix [4, 4] that does the same."""
        w, x, y, z = np.asarray(self.orientation, np.float64)
        made = np.eye(4)
        made[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        made[:3, 3] = self.position
        return made

    def __eq__(self, other: object) -> bool:
        """Bit by bit."""
        if not isinstance(other, Pose):
            return NotImplemented
        return equal(self.position, other.position) and equal(self.orientation, other.orientation)


def _quaternion(turn: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """w, x, y, z of a rotation, w not negative: the eigenvector of the largest eigenvalue.

    Source: Bar-Itzhack, "New method for extracting the quaternion from a rotation matrix", 2000.
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = turn
    symmetric = np.array(
        [
            [xx + yy + zz, zy - yz, xz - zx, yx - xy],
            [zy - yz, xx - yy - zz, xy + yx, xz + zx],
            [xz - zx, xy + yx, yy - xx - zz, yz + zy],
            [yx - xy, xz + zx, yz + zy, zz - xx - yy],
        ]
    )
    _, vectors = np.linalg.eigh(symmetric)
    made: npt.NDArray[np.float64] = vectors[:, -1]
    return -made if made[0] < 0 else made
