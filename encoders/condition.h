// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "encoders/tensor_plan.h"
#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// The numbers of another entity that condition predictions, for example the joints of the robot
/// that carries the camera.
///
/// Threading: const-parallel.
struct Condition {
  std::string entity;  ///< Its ID.
  TensorPlan plan;
  std::vector<double> mean;       ///< Per number.
  std::vector<double> deviation;  ///< Per number; 0 if it never changed.

  /// Returns the normalised numbers of one value of that entity; numbers that are not finite become
  /// 0.
  /// Shape: [1, K].
  /// Errors: kInvalidArgument if the value has another layout.
  [[nodiscard]] Result<torch::Tensor> read(const idf::Data& value) const;
};

/// Returns numbers minus their means, in units of their standard deviations. Numbers that are not
/// finite or never changed in training become 0.
[[nodiscard]] std::vector<float> normalised(std::span<const double> numbers,
                                            std::span<const double> mean,
                                            std::span<const double> deviation);

}  // namespace engram::encoders
