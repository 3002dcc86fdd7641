// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/core/status.h"
#include "training/measure/crossval_options.h"
#include "training/measure/crossval_report.h"

namespace engram::training {

/// Called with the result of each fold as soon as it is known, and the number of its recording.
using FoldSink = std::function<void(const CrossvalFold& fold, size_t number)>;

/// For each recording of an entity, trains models on all other recordings and measures them on the
/// left-out one. Nothing is published.
/// Errors: kInvalidArgument if there are fewer than two recordings, or a requested one does not
/// exist; kNotFound; kCancelled; the errors of the store and of training.
/// Threading: one at a time per process (train_model).
Result<CrossvalReport> crossval(const std::filesystem::path& store, const CrossvalOptions& options,
                                const ProgressSink& progress = {}, const std::stop_token& stop = {},
                                const FoldSink& on_fold = {});

}  // namespace engram::training
