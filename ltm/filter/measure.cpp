// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "ltm/idf/element_visit.h"

namespace engram::ltm {

namespace {

constexpr std::array<std::pair<std::string_view, Measure>, 9> kNames{{
    {"ignore", Measure::kIgnore},
    {"equal", Measure::kEqual},
    {"mse", Measure::kMse},
    {"mae", Measure::kMae},
    {"max_abs", Measure::kMaxAbs},
    {"rms", Measure::kRms},
    {"angle", Measure::kAngle},
    {"ssim", Measure::kSsim},
    {"cosine", Measure::kCosine},
}};

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

bool is_similarity(Measure measure) {
  return measure == Measure::kSsim || measure == Measure::kCosine;
}

/// |a - b|. For integers it is exact before the conversion to double: a signed difference could
/// overflow, and doubles of large integers lose their last digits.
template <typename T>
double distance(T a, T b) {
  if constexpr (std::is_floating_point_v<T>) {
    return std::abs(static_cast<double>(a) - static_cast<double>(b));
  } else {
    using Unsigned = std::make_unsigned_t<T>;
    const auto wide_a = static_cast<Unsigned>(a);
    const auto wide_b = static_cast<Unsigned>(b);
    return static_cast<double>(static_cast<Unsigned>(a > b ? wide_a - wide_b : wide_b - wide_a));
  }
}

std::array<double, 4> quaternion(const idf::NdArray& array) {
  std::array<double, 4> q{};
  idf::visit_element_type(array.type(), [&]<typename T>(T) {
    std::ranges::transform(array.values<T>(), q.begin(),
                           [](T value) { return static_cast<double>(value); });
  });
  const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  for (double& part : q) part /= norm;
  return q;
}

}  // namespace

std::string_view to_string(Measure measure) {
  for (const auto& [name, known] : kNames)
    if (known == measure) return name;
  return "unknown";
}

std::optional<Measure> measure_from_name(std::string_view name) {
  for (const auto& [known, measure] : kNames)
    if (known == name) return measure;
  return std::nullopt;
}

bool is_image_measure(Measure measure) {
  return measure == Measure::kMse || measure == Measure::kMae || measure == Measure::kSsim;
}

Status Similarity::validate() const {
  if (measure == Measure::kIgnore || measure == Measure::kEqual) return {};
  const bool is_in_range = is_similarity(measure) ? std::abs(bound) <= 1 : bound >= 0;
  if (std::isfinite(bound) && is_in_range) return {};
  return invalid_argument("measure '{}': bound is {}, needs {}", to_string(measure), bound,
                          is_similarity(measure) ? "-1 to 1" : "a number from 0 on");
}

bool Similarity::admits(double measured) const {
  return is_similarity(measure) ? measured >= bound : measured <= bound;
}

void NumberDifference::add(const idf::NdArray& a, const idf::NdArray& b) {
  ENGRAM_CHECK(a.type() == b.type() && a.shape() == b.shape(), "{} and {} differ",
               idf::to_string(a.shape()), idf::to_string(b.shape()));
  idf::visit_element_type(a.type(), [&]<typename T>(T) {
    const auto values_a = a.values<T>();
    const auto values_b = b.values<T>();
    count_ += static_cast<double>(values_a.size());
    for (size_t i = 0; i < values_a.size(); ++i) {
      const auto x = static_cast<double>(values_a[i]);
      const auto y = static_cast<double>(values_b[i]);
      if (!std::isfinite(x) || !std::isfinite(y)) {
        if (x != y && !(std::isnan(x) && std::isnan(y))) is_broken_ = true;
        continue;
      }
      const double apart = distance(values_a[i], values_b[i]);
      max_ = std::max(max_, apart);
      sum_ += apart;
      squares_ += apart * apart;
      dot_ += x * y;
      norm_a_ += x * x;
      norm_b_ += y * y;
    }
  });
}

double NumberDifference::measured(Measure measure) const {
  if (is_broken_) return kNan;
  const double count = std::max(count_, 1.0);
  switch (measure) {
    case Measure::kMse:
      return squares_ / count;
    case Measure::kMae:
      return sum_ / count;
    case Measure::kMaxAbs:
      return max_;
    case Measure::kRms:
      return std::sqrt(squares_ / count);
    case Measure::kCosine:
      if (max_ == 0) return 1;
      return norm_a_ == 0 || norm_b_ == 0 ? kNan : dot_ / (std::sqrt(norm_a_) * std::sqrt(norm_b_));
    default:
      break;
  }
  ENGRAM_CHECK(false, "'{}' is no measure of numbers", to_string(measure));
  return kNan;
}

double rotation_angle_rad(const idf::NdArray& a, const idf::NdArray& b) {
  if (a.count() != 4 || b.count() != 4) return kNan;
  const auto qa = quaternion(a);
  const auto qb = quaternion(b);
  double minus = 0, plus = 0;
  for (size_t i = 0; i < qa.size(); ++i) {
    minus += (qa[i] - qb[i]) * (qa[i] - qb[i]);
    plus += (qa[i] + qb[i]) * (qa[i] + qb[i]);
  }
  // q and -q are the same rotation. The arc tangent is exact at small angles, where acos is not.
  const double angle = 4 * std::atan2(std::sqrt(minus), std::sqrt(plus));
  return std::min(angle, 2 * std::numbers::pi - angle);
}

}  // namespace engram::ltm
