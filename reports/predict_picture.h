// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "training/measure/predicted_moment.h"

namespace engram::reports {

/// Draws a row per horizon: the last image, what came, what was predicted, and where that errs (8
/// times amplified). Where nothing came yet: the last image, the prediction, and where they differ.
/// Errors: kFailedPrecondition where the values have no colour or grey image; kUnavailable.
Status write_predict_picture(const training::PredictedMoment& moment,
                             const std::filesystem::path& picture);

}  // namespace engram::reports
