// SPDX-License-Identifier: Apache-2.0
#include "training/quality/psnr.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "ltm/core/not_a_number.h"

namespace engram::training {

namespace {

constexpr double kPeak = 255.0;

Status check_alike(const idf::NdArray& a, const idf::NdArray& b) {
  if (a.type() != idf::ElementType::kUInt8 || a.shape().size() != 3)
    return invalid_argument("image: needs uint8 [H, W, C], found {} {}", idf::to_string(a.type()),
                            idf::to_string(a.shape()));
  if (a.type() != b.type() || a.shape() != b.shape())
    return invalid_argument("images: {} {} beside {} {}, need to be alike",
                            idf::to_string(a.type()), idf::to_string(a.shape()),
                            idf::to_string(b.type()), idf::to_string(b.shape()));
  return {};
}

uint64_t squared(uint8_t a, uint8_t b) {
  const int difference = int{a} - int{b};
  return static_cast<uint64_t>(difference * difference);
}

}  // namespace

double psnr_db(double mse) {
  if (std::isnan(mse)) return mse;
  if (mse <= 0) return kLargestPsnrDb;
  return std::min(kLargestPsnrDb, 10.0 * std::log10(kPeak * kPeak / mse));
}

bool is_as_told(double found_mse, double told_mse) {
  return std::isnan(found_mse) || found_mse <= told_mse * 1.02 + 1e-9 ||
         std::sqrt(found_mse) <= std::sqrt(told_mse) + 1;
}

double mse_of_psnr(double db) {
  return kPeak * kPeak * std::pow(10.0, -db / 10.0);
}

Result<double> image_mse(const idf::NdArray& recorded, const idf::NdArray& other) {
  ENGRAM_RETURN_IF_ERROR(check_alike(recorded, other));
  const auto a = recorded.values<uint8_t>(), b = other.values<uint8_t>();
  uint64_t sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += squared(a[i], b[i]);
  return a.empty() ? kNaN : static_cast<double>(sum) / static_cast<double>(a.size());
}

Result<double> moving_mse(const idf::NdArray& before, const idf::NdArray& recorded,
                          const idf::NdArray& other, int threshold) {
  ENGRAM_RETURN_IF_ERROR(check_alike(recorded, other));
  ENGRAM_RETURN_IF_ERROR(check_alike(recorded, before));
  const auto old = before.values<uint8_t>(), a = recorded.values<uint8_t>(),
             b = other.values<uint8_t>();
  const auto channels = static_cast<size_t>(recorded.shape()[2]);
  // A pixel moves if any of its channels does, so that all of its channels count or none.
  uint64_t sum = 0, count = 0;
  for (size_t at = 0; channels > 0 && at < a.size(); at += channels) {
    bool is_moving = false;
    uint64_t error = 0;
    for (size_t i = at; i < at + channels; ++i) {
      is_moving |= std::abs(int{a[i]} - int{old[i]}) > threshold;
      error += squared(a[i], b[i]);
    }
    if (!is_moving) continue;
    sum += error;
    count += channels;
  }
  return count == 0 ? kNaN : static_cast<double>(sum) / static_cast<double>(count);
}

void PsnrStatistics::add(double mse) {
  if (std::isnan(mse)) return;
  values_db_.push_back(psnr_db(mse));
  mse_sum_ += mse;
  if (values_db_.back() >= kLargestPsnrDb) ++capped_;
}

void PsnrStatistics::add(const PsnrStatistics& more) {
  // Indices stay valid if `more` is this object, while iterators would not.
  for (size_t i = 0, count = more.values_db_.size(); i < count; ++i)
    values_db_.push_back(more.values_db_[i]);
  mse_sum_ += more.mse_sum_;
  capped_ += more.capped_;
}

double PsnrStatistics::mean_db() const {
  if (values_db_.empty()) return kNaN;
  double sum = 0;
  for (const double value : values_db_) sum += value;
  return sum / static_cast<double>(values_db_.size());
}

double PsnrStatistics::pooled_db() const {
  return values_db_.empty() ? kNaN : psnr_db(mse_sum_ / static_cast<double>(values_db_.size()));
}

double PsnrStatistics::minimum_db() const {
  return quantile_db(0);
}

double PsnrStatistics::quantile_db(double share) const {
  if (values_db_.empty()) return kNaN;
  std::vector<double> sorted = values_db_;
  std::sort(sorted.begin(), sorted.end());
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<size_t>(position);
  const size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

}  // namespace engram::training
