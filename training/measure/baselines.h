// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "encoders/tensor_plan.h"

namespace engram::training {

/// Predictions without learning, which a model must beat.
enum class Baseline {
  kCopyLast,  ///< The last value.
  kLinear,    ///< A straight line through the last two values, per pixel and number.
  kFlow,      ///< Images extrapolated by optical flow, numbers as a straight line.
};
inline constexpr size_t kBaselines = 3;

/// "copy-last", "linear", "flow".
[[nodiscard]] std::string_view to_string(Baseline baseline);

/// Predicts the values at 1..`steps` steps after `last`.
/// Errors: kInvalidArgument if a value does not have the plan's layout; kUnavailable if OpenCV
/// fails.
Result<std::vector<idf::Data>> predict_by(Baseline baseline, const encoders::TensorPlan& plan,
                                          const idf::Data& before, const idf::Data& last,
                                          int steps);

}  // namespace engram::training
