// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/core/status.h"
#include "training/measure/evaluate_options.h"
#include "training/measure/evaluate_report.h"

namespace engram::training {

/// Measures the models of a store against the recorded snapshots that it still holds.
///
/// Reconstructions are decoded from the stored latents. Predictions start from the last two
/// recorded snapshots, one and two ahead, and never cross a gap between recordings.
/// Errors: kInvalidArgument; kCancelled; the errors of the store and of loading models.
Result<EvalReport> evaluate(const std::filesystem::path& store, const EvaluateOptions& options,
                            const ProgressSink& progress = {}, const std::stop_token& stop = {});

}  // namespace engram::training
