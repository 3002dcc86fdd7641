// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "training/fit/dataset.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// The rounded latents of all rows, kept as 16-bit integers.
struct LatentTable {
  std::vector<encoders::ImageLatents> images;
  torch::Tensor numbers;
  torch::Tensor scene;

  [[nodiscard]] encoders::Latents rows(const torch::Tensor& indices) const;
};

[[nodiscard]] LatentTable encode_all(encoders::DeepModel& model, const Dataset& data);

}  // namespace engram::training
