// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "encoders/tensor_plan.h"

namespace engram::training {

/// Ways to predict that learn nothing: what a model must beat.
enum class Baseline {
  kCopyLast,  ///< The last value again.
  kLinear,    ///< A straight line through the last two, per pixel and number.
  kFlow,      ///< Images move on by optical flow, numbers as a straight line.
};
inline constexpr size_t kBaselines = 3;

/// "copy-last", "linear", "flow".
[[nodiscard]] std::string_view to_string(Baseline baseline);

/// The values 1..`steps` steps after `last`.
/// Errors: kInvalidArgument where a value is not of the plan's layout; kUnavailable where OpenCV
/// fails.
Result<std::vector<idf::Data>> predict_by(Baseline baseline, const encoders::TensorPlan& plan,
                                          const idf::Data& before, const idf::Data& last,
                                          int steps);

}  // namespace engram::training
