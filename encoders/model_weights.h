// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/deep_model.h"
#include "ltm/h5/h5.h"

// Private to this room: includes LibTorch.

namespace engram::encoders {

/// Writes the weights of both networks as "/weights" of a model file. They were rounded by
/// round_weights.
Status write_weights(h5::File& file, DeepModel& model);

/// Reads the weights into networks of the same sizes. It is safe on hostile files.
/// Errors: kDataLoss if the file has more or fewer weights than the networks.
Status read_weights(const h5::File& file, DeepModel& model);

/// Elements of a tensor, row by row.
[[nodiscard]] std::vector<float> floats_of(const torch::Tensor& tensor);

}  // namespace engram::encoders
