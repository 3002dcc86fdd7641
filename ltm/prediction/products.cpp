// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/products.h"

#include <algorithm>

// The Fortran functions that every BLAS has. Headers of BLAS differ between libraries.
extern "C" {
void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* beta, double* c, const int* ldc);
void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k,
            const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
            const double* beta, double* c, const int* ldc);
// Only OpenBLAS has this one. With another BLAS the address of the weak symbol is null.
[[gnu::weak]] void openblas_set_num_threads(int threads);
}

namespace engram::ltm {

namespace {

constexpr double kOne = 1, kZero = 0;

/// A thread that predicts is one of many: each with a pool of its own would be too many threads.
void use_one_thread() {
  [[maybe_unused]] static const bool is_set = [] {
    if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);
    return true;
  }();
}

}  // namespace

Eigen::MatrixXd squared(const Eigen::MatrixXd& x) {
  use_one_thread();
  const int columns = static_cast<int>(x.cols()), rows = static_cast<int>(x.rows());
  const int stride = std::max(rows, 1);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(columns, columns);
  if (columns == 0) return result;
  // Half of a symmetric matrix is half of the work.
  dsyrk_("L", "T", &columns, &rows, &kOne, x.data(), &stride, &kZero, result.data(), &columns);
  result.triangularView<Eigen::StrictlyUpper>() = result.transpose();
  return result;
}

Eigen::MatrixXd product(const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
  use_one_thread();
  const int features = static_cast<int>(x.cols()), numbers = static_cast<int>(y.cols());
  const int rows = static_cast<int>(x.rows()), stride = std::max(rows, 1);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(features, numbers);
  if (features == 0 || numbers == 0) return result;
  dgemm_("T", "N", &features, &numbers, &rows, &kOne, x.data(), &stride, y.data(), &stride, &kZero,
         result.data(), &features);
  return result;
}

}  // namespace engram::ltm
