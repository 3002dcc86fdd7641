// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/recall/model.h"

namespace engram::encoders {

/// Opens a model file and tests that it still decodes as it did when it was written. It can be used
/// as an ltm::ModelLoader.
/// Threading: encoder and predictor share the networks, so use both from one thread.
/// Errors: kNotFound; kDataLoss if the file is damaged or fails its test; kFailedPrecondition if
/// its format version is another one.
Result<ltm::LoadedModel> load_model(const std::filesystem::path& path);

}  // namespace engram::encoders
