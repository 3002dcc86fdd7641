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

/// Writes into a model file what its model was chosen over: what save_model would have written with
/// it, without coding the weights again. The size of the file stays the same, so that the choice
/// can tell it.
/// Errors: kNotFound; kDataLoss where it is no model file or cannot be written.
Status note_choice(const ModelChoice& choice, const std::filesystem::path& path);

/// Reads a model and runs its self test. Safe on hostile files.
/// Errors: kNotFound; kDataLoss where the file is damaged or decodes its own example differently;
/// kFailedPrecondition where its format is another.
Result<std::shared_ptr<DeepModel>> read_model(const std::filesystem::path& path);

}  // namespace engram::encoders
