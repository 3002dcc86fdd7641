// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "encoders/deep_model.h"
#include "encoders/model_file.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::encoders {

/// Writes a model whose weights were rounded by round_weights, with a self test.
/// Errors: kAlreadyExists; kUnavailable; the errors of encoding.
Status save_model(DeepModel& model, const std::filesystem::path& path);

/// Writes the choice between models into an existing model file, as save_model would have, without
/// coding the weights again. The size of the file does not change, because the choice contains that
/// size.
/// Errors: kNotFound; kDataLoss if it is no model file or cannot be written.
Status note_choice(const ModelChoice& choice, const std::filesystem::path& path);

/// Reads a model and runs its self test. It is safe on hostile files.
/// Errors: kNotFound; kDataLoss if the file is damaged or decodes its own example differently;
/// kFailedPrecondition if its format version is another one.
Result<std::shared_ptr<DeepModel>> read_model(const std::filesystem::path& path);

}  // namespace engram::encoders
