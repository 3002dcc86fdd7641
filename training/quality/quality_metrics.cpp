// SPDX-License-Identifier: Apache-2.0
#include "training/quality/quality_metrics.h"

#include <algorithm>
#include <cmath>

#include "ltm/core/not_a_number.h"
#include "ltm/idf/element_visit.h"
#include "ltm/idf/layout.h"
#include "training/quality/ssim.h"

namespace engram::training {

namespace {

constexpr double kPeakValue = 255.0;

struct ErrorSum {
  double sum = 0;
  double count = 0;

  void add(double a, double b, double scale) {
    // Equal infinities have a difference of NaN, and NaN is not equal to itself, so both are
    // checked before.
    const bool is_equal = a == b || (std::isnan(a) && std::isnan(b));
    const double difference = is_equal ? 0.0 : (a - b) * scale;
    sum += std::isfinite(difference) ? difference * difference
                                     : std::numeric_limits<double>::infinity();
    count += 1;
  }

  [[nodiscard]] double mean() const { return count > 0 ? sum / count : kNaN; }
};

void add_bytes(std::span<const uint8_t> a, std::span<const uint8_t> b, ErrorSum& error) {
  uint64_t sum = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const int difference = int{a[i]} - int{b[i]};
    sum += static_cast<uint64_t>(difference * difference);
  }
  error.sum += static_cast<double>(sum);
  error.count += static_cast<double>(a.size());
}

void add_depth(std::span<const uint16_t> a, std::span<const uint16_t> b, ErrorSum& error) {
  // Depth has no fixed range, so the largest recorded value counts as 255 grey levels.
  const uint16_t largest = a.empty() ? uint16_t{1} : *std::max_element(a.begin(), a.end());
  const double scale = kPeakValue / std::max<uint16_t>(largest, 1);
  for (size_t i = 0; i < a.size(); ++i) error.add(a[i], b[i], scale);
}

void add_numbers(const idf::NdArray& a, const idf::NdArray& b, ErrorSum& error) {
  idf::visit_element_type(a.type(), [&]<typename T>(T) {
    const auto left = a.values<T>();
    const auto right = b.values<T>();
    for (size_t i = 0; i < left.size(); ++i)
      error.add(static_cast<double>(left[i]), static_cast<double>(right[i]), 1.0);
  });
}

bool is_unit_quaternion(const idf::NdArray& array) {
  if (array.shape() != idf::Shape{4}) return false;
  return idf::visit_element_type(array.type(), [&]<typename T>(T) {
    if constexpr (!std::is_floating_point_v<T>) {
      return false;
    } else {
      double square = 0;
      for (const T element : array.values<T>()) square += double{element} * double{element};
      return std::abs(std::sqrt(square) - 1) < 1e-3;
    }
  });
}

/// Adds the smaller error of the two signs of a quaternion, which stand for the same rotation.
void add_rotation(const idf::NdArray& a, const idf::NdArray& b, ErrorSum& error) {
  ErrorSum same, opposite;
  idf::visit_element_type(a.type(), [&]<typename T>(T) {
    for (size_t i = 0; i < 4; ++i) {
      const auto left = static_cast<double>(a.values<T>()[i]);
      const auto right = static_cast<double>(b.values<T>()[i]);
      same.add(left, right, 1.0);
      opposite.add(left, -right, 1.0);
    }
  });
  error.sum += std::min(same.sum, opposite.sum);
  error.count += same.count;
}

Result<ltm::MeasuredError> compared(const idf::Data& recorded, const idf::Data& other,
                                    bool is_prediction, const std::vector<std::string>& uncounted) {
  const idf::Layout layout = idf::Layout::of(recorded);
  ENGRAM_ASSIGN_OR_RETURN(const auto a, layout.split(recorded));
  ENGRAM_ASSIGN_OR_RETURN(const auto b, layout.split(other));
  ErrorSum images;
  ErrorSum numbers;
  for (size_t i = 0; i < a.tensors.size(); ++i) {
    const idf::TensorMember& member = layout.members()[i];
    if (is_prediction && member.kind == idf::MemberKind::kBool) continue;
    if (std::ranges::find(uncounted, member.path) != uncounted.end()) continue;
    if (member.kind != idf::MemberKind::kImage) {
      if (is_prediction && is_unit_quaternion(a.tensors[i]) && is_unit_quaternion(b.tensors[i]))
        add_rotation(a.tensors[i], b.tensors[i], numbers);
      else
        add_numbers(a.tensors[i], b.tensors[i], numbers);
    } else if (member.type == idf::ElementType::kUInt8) {
      add_bytes(a.tensors[i].values<uint8_t>(), b.tensors[i].values<uint8_t>(), images);
    } else {
      add_depth(a.tensors[i].values<uint16_t>(), b.tensors[i].values<uint16_t>(), images);
    }
  }
  return ltm::MeasuredError{images.mean(), numbers.mean()};
}

}  // namespace

Result<ltm::MeasuredError> compare(const idf::Data& recorded, const idf::Data& other) {
  return compared(recorded, other, false, {});
}

Result<ltm::MeasuredError> compare_prediction(const idf::Data& recorded, const idf::Data& predicted,
                                              const std::vector<std::string>& uncounted) {
  return compared(recorded, predicted, true, uncounted);
}

Result<double> mean_ssim(const idf::Data& recorded, const idf::Data& other) {
  constexpr int64_t kWindow = 11;
  const idf::Layout layout = idf::Layout::of(recorded);
  ENGRAM_ASSIGN_OR_RETURN(const auto a, layout.split(recorded));
  ENGRAM_ASSIGN_OR_RETURN(const auto b, layout.split(other));
  double sum = 0;
  int images = 0;
  for (size_t i = 0; i < a.tensors.size(); ++i) {
    const idf::TensorMember& member = layout.members()[i];
    const auto& shape = a.tensors[i].shape();
    if (member.kind != idf::MemberKind::kImage || member.type != idf::ElementType::kUInt8 ||
        shape[0] < kWindow || shape[1] < kWindow)
      continue;
    ENGRAM_ASSIGN_OR_RETURN(const double one, ssim(a.tensors[i], b.tensors[i]));
    sum += one;
    ++images;
  }
  return images == 0 ? kNaN : sum / images;
}

Result<double> grey_mse(const idf::NdArray& recorded, const idf::NdArray& other) {
  if (recorded.type() == idf::ElementType::kUInt8) return image_mse(recorded, other);
  if (recorded.type() != idf::ElementType::kUInt16 || other.type() != recorded.type() ||
      other.shape() != recorded.shape())
    return invalid_argument("images: found {} {} and {} {}, needs two alike of uint8 or uint16",
                            idf::to_string(recorded.type()), idf::to_string(recorded.shape()),
                            idf::to_string(other.type()), idf::to_string(other.shape()));
  ErrorSum error;
  add_depth(recorded.values<uint16_t>(), other.values<uint16_t>(), error);
  return error.mean();
}

void RmseStatistics::add(double mse) {
  if (std::isnan(mse)) return;
  mse_sum_ += mse;
  ++count_;
}

void RmseStatistics::add(const RmseStatistics& more) {
  mse_sum_ += more.mse_sum_;
  count_ += more.count_;
}

double RmseStatistics::rmse() const {
  return count_ == 0 ? kNaN : std::sqrt(mse_sum_ / static_cast<double>(count_));
}

}  // namespace engram::training
