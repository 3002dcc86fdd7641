// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/deep_model.h"
#include "ltm/h5/h5.h"

// Private to this room: includes LibTorch.

namespace engram::encoders {

/// Writes the code of an example and the value that the model decodes from it, as "/self_test" of a
/// model file. The example is made up: a recorded one would stay in the model after it was
/// forgotten.
/// Errors: the errors of DeepModel::encode.
Status write_self_test(h5::File& file, DeepModel& model);

/// Decodes that code again and compares the values. It is safe on hostile files.
/// Errors: kDataLoss if they differ by more than machines may differ.
Status run_self_test(const h5::File& file, DeepModel& model);

}  // namespace engram::encoders
