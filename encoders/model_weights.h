// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/deep_model.h"
#include "ltm/h5/h5.h"

// Private to this room: includes LibTorch.

namespace engram::encoders {

/// Writes the weights of both networks, which round_weights rounded: "/weights" of a model file.
Status write_weights(h5::File& file, DeepModel& model);

/// Reads them into networks of the same sizes. Safe on hostile files.
/// Errors: kDataLoss where there are more or fewer than the networks have.
Status read_weights(const h5::File& file, DeepModel& model);

/// Elements of a tensor, row by row.
[[nodiscard]] std::vector<float> floats_of(const torch::Tensor& tensor);

}  // namespace engram::encoders
