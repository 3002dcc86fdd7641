// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "ltm/core/time.h"
#include "ltm/idf/ndarray.h"

namespace engram::ltm {

using engram::to_string;

/// How far two tensors of the same type and shape are apart.
enum class Measure : uint8_t {
  kIgnore,  ///< Not at all, whatever they hold.
  kEqual,   ///< Bit by bit; the bound does not matter.
  // Distances: similar up to the bound.
  kMse,     ///< Mean squared difference. Unit: that of the number, squared.
  kMae,     ///< Mean absolute difference. Unit: that of the number.
  kMaxAbs,  ///< Largest absolute difference. Unit: that of the number.
  kRms,     ///< Root of the mean squared difference. Unit: that of the number.
  kAngle,   ///< Angle between two rotations, as quaternions w, x, y, z. Unit: rad.
  // Similarities: similar from the bound on.
  kSsim,    ///< Mean structural similarity of two images: 1 where they are equal.
  kCosine,  ///< Cosine of the angle between the numbers as vectors: 1 where it is the same.
};

/// "ignore", "equal", "mse", ...
[[nodiscard]] std::string_view to_string(Measure measure);
[[nodiscard]] std::optional<Measure> measure_from_name(std::string_view name);

/// True for kMse, kMae and kSsim, which look at images on a reduced copy.
[[nodiscard]] bool is_image_measure(Measure measure);

/// A measure, and what is similar by it.
struct Similarity {
  Measure measure = Measure::kEqual;
  double bound = 0;

  /// Errors: kInvalidArgument where the bound is no number or out of the measure's range.
  [[nodiscard]] Status validate() const;

  /// True where a measured value is similar. NaN is not.
  [[nodiscard]] bool admits(double measured) const;
};

/// Differences of numbers, gathered over any number of tensors that are measured as one vector.
///
/// A NaN equals a NaN, an infinity itself; where only one is, everything differs.
/// Complexity of add: O(number of elements).
class NumberDifference {
 public:
  /// Arrays of the same type and shape (checked).
  void add(const idf::NdArray& a, const idf::NdArray& b);

  /// By kMse, kMae, kMaxAbs, kRms or kCosine (checked). NaN where everything differs.
  [[nodiscard]] double measured(Measure measure) const;

 private:
  double count_ = 0;
  double max_ = 0;
  double sum_ = 0;
  double squares_ = 0;
  double dot_ = 0;
  double norm_a_ = 0;
  double norm_b_ = 0;
  bool is_broken_ = false;
};

/// The angle between two rotations given as quaternions of any length but zero. Unit: rad, 0 to pi.
/// NaN where one is no rotation.
/// Shape: float32 or float64 [4].
[[nodiscard]] double rotation_angle_rad(const idf::NdArray& a, const idf::NdArray& b);

}  // namespace engram::ltm
