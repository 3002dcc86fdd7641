// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "ltm/core/time.h"
#include "ltm/idf/ndarray.h"

namespace engram::ltm {

using engram::to_string;

/// How to compare two tensors of the same type and shape.
enum class Measure : uint8_t {
  kIgnore,  ///< Any two are similar.
  kEqual,   ///< Equal bit by bit; the bound is not used.
  // Distances: tensors are similar up to the bound.
  kMse,     ///< Mean squared difference. Unit: that of the number, squared.
  kMae,     ///< Mean absolute difference. Unit: that of the number.
  kMaxAbs,  ///< Largest absolute difference. Unit: that of the number.
  kRms,     ///< Root of the mean squared difference. Unit: that of the number.
  kAngle,   ///< Angle between two rotations, as quaternions w, x, y, z. Unit: rad.
  // Similarities: tensors are similar from the bound on.
  kSsim,    ///< Mean structural similarity of two images: 1 if they are equal.
  kCosine,  ///< Cosine of the angle between the numbers as vectors: 1 for the same direction.
};

/// The name in configurations: "ignore", "equal", "mse", ...
[[nodiscard]] std::string_view to_string(Measure measure);
[[nodiscard]] std::optional<Measure> measure_from_name(std::string_view name);

/// True for kMse, kMae and kSsim, which compare reduced copies of images.
[[nodiscard]] bool is_image_measure(Measure measure);

/// A measure and the bound for being similar.
struct Similarity {
  Measure measure = Measure::kEqual;
  double bound = 0;

  /// Errors: kInvalidArgument if the bound is not finite or out of the measure's range.
  [[nodiscard]] Status validate() const;

  /// True if a measured value means similar. NaN does not.
  [[nodiscard]] bool admits(double measured) const;
};

/// Gathers differences of numbers over any number of tensors, which are measured as one vector.
///
/// NaN equals NaN and an infinity equals itself. Any other pair with a number that is not finite
/// makes the whole differ.
/// Complexity of add: O(number of elements).
class NumberDifference {
 public:
  /// Adds two arrays of the same type and shape (checked).
  void add(const idf::NdArray& a, const idf::NdArray& b);

  /// Returns the kMse, kMae, kMaxAbs, kRms or kCosine (checked). NaN if the whole differs.
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

/// The angle between two rotations, given as quaternions of any length but zero. NaN if one is not
/// a rotation. Unit: rad, 0 to pi.
/// Shape: float32 or float64 [4].
[[nodiscard]] double rotation_angle_rad(const idf::NdArray& a, const idf::NdArray& b);

}  // namespace engram::ltm
