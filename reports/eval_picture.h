// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "ltm/core/status.h"

namespace engram::reports {

/// Draws moments of the first entity with images and a model: recorded, reconstructed, predicted
/// one snapshot ahead from the recorded past, and the error of the reconstruction (amplified 8
/// times).
/// Errors: kNotFound if there is no such entity or its recorded form is gone; kUnavailable.
Status write_eval_picture(const std::filesystem::path& store, const std::filesystem::path& picture);

}  // namespace engram::reports
