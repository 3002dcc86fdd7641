// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "encoders/tensor_plan.h"
#include "encoders/torch.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// The numbers of another entity that predictions start from: the joints of the robot whose camera
/// it is.
///
/// Threading: const-parallel.
struct Condition {
  std::string entity;  ///< Its ID.
  TensorPlan plan;
  std::vector<double> mean;       ///< Per number.
  std::vector<double> deviation;  ///< Per number; 0 where it never changed.

  /// Normalised numbers of one value of that entity; 0 for those that are not finite. [1, K]
  /// Errors: kInvalidArgument where it has another layout.
  [[nodiscard]] Result<torch::Tensor> read(const idf::Data& value) const;
};

/// Numbers in units of their deviation from the mean; 0 for those that are not finite or never
/// changed.
[[nodiscard]] std::vector<float> normalised(std::span<const double> numbers,
                                            std::span<const double> mean,
                                            std::span<const double> deviation);

}  // namespace engram::encoders
