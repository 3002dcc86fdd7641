// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "encoders/deep_model.h"
#include "ltm/h5/h5.h"

// Private to this room: includes LibTorch.

namespace engram::encoders {

/// Writes the code of `example` and what the model decodes from it: "/self_test" of a model file.
/// Errors: those of DeepModel::encode.
Status write_self_test(h5::File& file, DeepModel& model, const idf::Data& example);

/// Decodes that code again. Safe on hostile files.
/// Errors: kDataLoss where something else comes out, but for what machines differ in.
Status run_self_test(const h5::File& file, DeepModel& model);

}  // namespace engram::encoders
