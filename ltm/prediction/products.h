// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: products of large matrices.

#include <Eigen/Dense>

namespace engram::ltm {

/// x^T x. Shapes: x [rows, F], the result [F, F].
///
/// The system's BLAS computes it, on one thread: it uses what the processor has, and the compiler
/// only what all of them have, with which Eigen took six times as long. The same processor gives
/// the same bits.
/// Threading: thread-safe.
[[nodiscard]] Eigen::MatrixXd squared(const Eigen::MatrixXd& x);

/// x^T y. Shapes: x [rows, F], y [rows, N], the result [F, N].
/// Threading: thread-safe.
[[nodiscard]] Eigen::MatrixXd product(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y);

}  // namespace engram::ltm
