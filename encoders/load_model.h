// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/recall/model.h"

namespace engram::encoders {

/// Opens a model file and tests that it still decodes as it did when it was written. Usable as
/// ltm::ModelLoader. Encoder and predictor share the networks: use both from one thread.
/// Errors: kNotFound; kDataLoss where the file is damaged or fails its test; kFailedPrecondition
/// where its format is newer.
Result<ltm::LoadedModel> load_model(const std::filesystem::path& path);

}  // namespace engram::encoders
