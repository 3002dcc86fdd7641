// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "training/measure/predicted_moment.h"

namespace engram::reports {

/// Draws a row per horizon: the last image, the actual image, the prediction, and its error
/// (amplified 8 times). If nothing has come yet: the last image, the prediction, and their
/// difference.
/// Errors: kFailedPrecondition if the values have no colour or grey image; kUnavailable.
Status write_predict_picture(const training::PredictedMoment& moment,
                             const std::filesystem::path& picture);

}  // namespace engram::reports
