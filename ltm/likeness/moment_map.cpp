// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/moment_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Dense>

#include "ltm/likeness/coded_moments.h"

namespace engram::ltm {

namespace {

using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The codes of some moments, less their mean. Shape: [M, K].
Rows centred_codes(const CodedMoments& coded, const std::vector<size_t>& moments) {
  const auto numbers = static_cast<Eigen::Index>(coded.numbers);
  Rows rows(static_cast<Eigen::Index>(moments.size()), numbers);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const size_t at = moments[static_cast<size_t>(i)] * coded.numbers;
    for (Eigen::Index k = 0; k < numbers; ++k) {
      const size_t cell = at + static_cast<size_t>(k);
      rows(i, k) = coded.coded_by == CodedBy::kImages ? static_cast<float>(coded.bytes[cell])
                                                      : coded.floats[cell];
    }
  }
  rows.rowwise() -= rows.colwise().mean().eval();
  return rows;
}

/// The first two principal components of centred rows, [K, 2], by iterating a subspace of a few
/// more: codes of numbers may have thousands, of which a covariance would be dear.
Eigen::MatrixXf two_components(const Rows& rows) {
  constexpr Eigen::Index kSubspace = 8;
  constexpr int kIterations = 30;
  const Eigen::Index size = std::min({kSubspace, rows.cols(), rows.rows()});
  // Any start that is not orthogonal to the components; the same one each time.
  Eigen::MatrixXf basis(rows.cols(), size);
  for (Eigen::Index k = 0; k < basis.rows(); ++k)
    for (Eigen::Index j = 0; j < size; ++j)
      basis(k, j) = std::cos(static_cast<float>((k + 1) * (2 * j + 1)));
  const auto orthonormal = [size](const Eigen::MatrixXf& columns) -> Eigen::MatrixXf {
    return Eigen::HouseholderQR<Eigen::MatrixXf>(columns).householderQ() *
           Eigen::MatrixXf::Identity(columns.rows(), size);
  };
  basis = orthonormal(basis);
  for (int i = 0; i < kIterations; ++i) basis = orthonormal(rows.transpose() * (rows * basis));
  const Eigen::MatrixXf within = rows * basis;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(within.transpose() * within);
  const Eigen::MatrixXf sorted = solver.eigenvectors().rowwise().reverse();
  return basis * sorted.leftCols(std::min<Eigen::Index>(2, size));
}

}  // namespace

MomentMap map_of(const CodedMoments& coded, size_t max_moments) {
  MomentMap map;
  map.coded_by = coded.coded_by;
  map.space = coded.space_name();
  map.known = coded.size();
  const size_t count = std::min(max_moments, coded.size());
  std::vector<size_t> moments;
  for (size_t i = 0; i < count; ++i) moments.push_back(i * coded.size() / count);
  for (const size_t moment : moments) {
    map.times.push_back(coded.times[moment]);
    map.recordings.push_back(static_cast<uint32_t>(coded.recording_of(moment)));
  }
  map.x.resize(count);
  map.y.resize(count);
  if (count < 2 || coded.numbers == 0) return map;
  const Rows rows = centred_codes(coded, moments);
  const Eigen::MatrixXf components = two_components(rows);
  const double unit = coded.spread * std::sqrt(static_cast<double>(coded.numbers));
  const double total = rows.cast<double>().squaredNorm();
  if (!(total > 0) || !(unit > 0)) return map;
  for (Eigen::Index axis = 0; axis < components.cols(); ++axis) {
    Eigen::VectorXd along = (rows * components.col(axis)).cast<double>();
    if (along.array().cube().sum() < 0) along = -along;
    map.explained += along.squaredNorm() / total;
    std::vector<float>& to = axis == 0 ? map.x : map.y;
    for (size_t i = 0; i < count; ++i)
      to[i] = static_cast<float>(along[static_cast<Eigen::Index>(i)] / unit);
  }
  return map;
}

}  // namespace engram::ltm
