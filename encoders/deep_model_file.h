// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "encoders/deep_model.h"
#include "encoders/model_file.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// Writes a model whose weights round_weights rounded, with `example` as its self test.
/// Errors: kAlreadyExists, kUnavailable; those of encoding `example`.
Status save_model(DeepModel& model, const idf::Data& example, const std::filesystem::path& path);

/// Reads a model and runs its self test. Safe on hostile files.
/// Errors: kNotFound; kDataLoss where the file is damaged or decodes its own example differently;
/// kFailedPrecondition where its format is another.
Result<std::shared_ptr<DeepModel>> read_model(const std::filesystem::path& path);

}  // namespace engram::encoders
