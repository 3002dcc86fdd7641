// SPDX-License-Identifier: Apache-2.0
#include "training/forms/noise_floor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace engram::training {

namespace {

/// Median magnitude of a normal distribution with deviation 1.
constexpr double kNormalMedian = 0.6744897501960817;
/// Darker or brighter pixels are left out, because their noise may be clipped.
constexpr int kDarkest = 2, kBrightest = 253;

bool is_open(int value) {
  return value >= kDarkest && value <= kBrightest;
}

/// A histogram of magnitudes of whole numbers.
class Magnitudes {
 public:
  void add(int value) {
    ++counts_[static_cast<size_t>(std::abs(value))];
    ++total_;
  }

  [[nodiscard]] uint64_t total() const { return total_; }

  /// The median, with each number spread over 0.5 in both directions.
  [[nodiscard]] double median() const {
    const double half = static_cast<double>(total_) / 2;
    double below = 0;
    for (size_t i = 0; i < counts_.size(); ++i) {
      const auto own = static_cast<double>(counts_[i]);
      if (below + own < half || own == 0) {
        below += own;
        continue;
      }
      const double first = i == 0 ? 0 : static_cast<double>(i) - 0.5;
      const double width = i == 0 ? 0.5 : 1;
      return first + width * (half - below) / own;
    }
    return 0;
  }

 private:
  std::array<uint64_t, 1021> counts_{};  ///< Up to four times 255.
  uint64_t total_ = 0;
};

/// Deviation from the diagonal coefficients of the finest wavelets (Haar).
/// Source: Donoho and Johnstone, "Ideal spatial adaptation by wavelet shrinkage", 1994.
double deviation_in_space(const idf::NdArray& image) {
  const auto pixels = image.values<uint8_t>();
  const auto height = static_cast<size_t>(image.shape()[0]);
  const auto width = static_cast<size_t>(image.shape()[1]);
  const auto channels = static_cast<size_t>(image.shape()[2]);
  Magnitudes magnitudes;
  for (size_t y = 0; y + 1 < height; y += 2)
    for (size_t x = 0; x + 1 < width; x += 2)
      for (size_t c = 0; c < channels; ++c) {
        const auto at = [&](size_t dy, size_t dx) {
          return int{pixels[((y + dy) * width + x + dx) * channels + c]};
        };
        if (!is_open(at(0, 0)) || !is_open(at(0, 1)) || !is_open(at(1, 0)) || !is_open(at(1, 1)))
          continue;
        magnitudes.add(at(0, 0) - at(0, 1) - at(1, 0) + at(1, 1));
      }
  // The sum of four has twice the deviation of one.
  return magnitudes.median() / kNormalMedian / 2;
}

double deviation_in_time(const idf::NdArray& image, const idf::NdArray& next) {
  const auto a = image.values<uint8_t>(), b = next.values<uint8_t>();
  Magnitudes magnitudes;
  for (size_t i = 0; i < a.size(); ++i)
    if (is_open(a[i]) && is_open(b[i])) magnitudes.add(int{a[i]} - int{b[i]});
  return magnitudes.median() / kNormalMedian / std::sqrt(2.0);
}

}  // namespace

Status NoiseFloor::add(const idf::NdArray& image, const idf::NdArray& next) {
  if (image.type() != next.type() || image.shape() != next.shape() || image.shape().size() != 3)
    return invalid_argument("images: found {} {} and {} {}, needs two alike of [H, W, C]",
                            idf::to_string(image.type()), idf::to_string(image.shape()),
                            idf::to_string(next.type()), idf::to_string(next.shape()));
  if (image.type() != idf::ElementType::kUInt8) return {};
  deviations_.push_back(std::min(deviation_in_space(image), deviation_in_time(image, next)));
  return {};
}

std::optional<double> NoiseFloor::deviation() const {
  if (deviations_.empty()) return std::nullopt;
  std::vector<double> sorted = deviations_;
  const auto middle = sorted.begin() + static_cast<ptrdiff_t>(sorted.size() / 2);
  std::ranges::nth_element(sorted, middle);
  return *middle;
}

double bound_of_noise(double deviation) {
  const double psnr = 20 * std::log10(255.0 / std::max(deviation, 1e-3));
  return std::clamp(psnr, kMinNoiseBoundDb, kMaxNoiseBoundDb);
}

}  // namespace engram::training
