// SPDX-License-Identifier: Apache-2.0
#include "encoders/gist_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ltm/core/check.h"

namespace engram::encoders {

namespace {

/// Inner products of all rows that are at most `gap` apart.
///
/// Every interpolation error is a sum of six of them, so that each pair of rows is read once,
/// although the search looks at every row between every two rows.
class RowProducts {
 public:
  RowProducts(std::span<const std::vector<uint8_t>> rows, size_t gap) : width_(gap + 1) {
    products_.resize(rows.size() * width_);
    for (size_t i = 0; i < rows.size(); ++i)
      for (size_t back = 0; back <= std::min(gap, i); ++back)
        products_[i * width_ + back] = product(rows[i], rows[i - back]);
    values_ = static_cast<double>(rows.front().size());
  }

  /// Mean squared error of row `i`, interpolated between rows `a` and `b`. a <= i <= b.
  [[nodiscard]] double mse(size_t a, size_t i, size_t b) const {
    const double to_b = static_cast<double>(i - a) / static_cast<double>(b - a);
    const double to_a = 1 - to_b;
    const double sum = of(i, i) + to_a * to_a * of(a, a) + to_b * to_b * of(b, b) +
                       2 * (to_a * to_b * of(a, b) - to_a * of(a, i) - to_b * of(i, b));
    return std::max(sum, 0.0) / values_;
  }

 private:
  static double product(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
    ENGRAM_CHECK(a.size() == b.size(), "rows of {} and {} values", a.size(), b.size());
    // A product is below 2^16, so 32 bits hold the sum of as many.
    constexpr size_t kPart = size_t{1} << 16;
    double sum = 0;
    for (size_t from = 0; from < a.size(); from += kPart) {
      uint32_t part = 0;
      for (size_t i = from; i < std::min(a.size(), from + kPart); ++i)
        part += static_cast<uint32_t>(a[i]) * b[i];
      sum += part;
    }
    return sum;
  }

  [[nodiscard]] double of(size_t before, size_t row) const {
    return products_[row * width_ + (row - before)];
  }

  size_t width_;
  double values_ = 0;
  std::vector<double> products_;  ///< [row, how many rows before].
};

/// PSNR lost in the rows from `a` (excluded) to `b`, whose ends are kept. Unit: dB.
double lost_db(const RowProducts& products, size_t a, size_t b, double coding_mse) {
  double lost = 0;
  for (size_t i = a + 1; i < b; ++i)
    lost += 10 * std::log10(1 + products.mse(a, i, b) / coding_mse);
  return lost;
}

}  // namespace

std::vector<size_t> choose_gist_rows(std::span<const std::vector<uint8_t>> rows,
                                     const GistRowOptions& options) {
  ENGRAM_CHECK(!rows.empty(), "no rows");
  const RowProducts products(rows, options.max_gap);
  // The smallest loss up to each row if it is kept, and the row kept before it.
  std::vector<double> loss(rows.size(), std::numeric_limits<double>::infinity());
  std::vector<size_t> before(rows.size(), 0);
  loss[0] = 0;
  for (size_t b = 1; b < rows.size(); ++b)
    for (size_t a = b - std::min(b, options.max_gap); a < b; ++a) {
      const double with_a = loss[a] + options.gain_db + lost_db(products, a, b, options.coding_mse);
      if (with_a >= loss[b]) continue;
      loss[b] = with_a;
      before[b] = a;
    }
  std::vector<size_t> kept{rows.size() - 1};
  while (kept.back() > 0) kept.push_back(before[kept.back()]);
  std::ranges::reverse(kept);
  return kept;
}

}  // namespace engram::encoders
