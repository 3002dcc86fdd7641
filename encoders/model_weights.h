// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "encoders/deep_model.h"
#include "encoders/stored_tensors.h"
#include "ltm/h5/h5.h"

// Private to this room: includes LibTorch.

namespace engram::encoders {

/// Writes the weights of both networks as "/weights" of a model file. They were rounded by
/// round_weights.
Status write_weights(h5::File& file, DeepModel& model);

/// Reads the weights into networks of the same sizes. It is safe on hostile files.
/// Errors: kDataLoss if the file has more or fewer weights than the networks.
Status read_weights(const h5::File& file, DeepModel& model);

}  // namespace engram::encoders
