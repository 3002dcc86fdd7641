// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <stop_token>

#include "ltm/core/progress.h"
#include "ltm/core/status.h"
#include "training/fit/train_control.h"
#include "training/fit/train_options.h"
#include "training/fit/train_report.h"
#include "training/fit/training_source.h"

namespace engram::encoders {
struct DeepModel;
}

namespace engram::training {

/// A model that was made, with the weights that a model file keeps, and how.
struct FittedModel {
  std::shared_ptr<encoders::DeepModel> model;
  TrainReport training;
};

/// Trains a model on `source`.
///
/// Errors: kInvalidArgument where the values cannot be tensors; kCancelled on `stop`;
/// kResourceExhausted where memory ends, or the time of control.pace while the robot is busy;
/// those of source.read.
/// Threading: one at a time per process; uses LibTorch's global random generator and threads.
Result<FittedModel> fit_model(const TrainingSource& source, const TrainOptions& options,
                              const ProgressSink& progress, const std::stop_token& stop,
                              const TrainControl& control = {});

/// Trains a model and writes it to `file`, which must not exist.
/// Errors, threading: as of fit_model; those of writing.
Result<TrainReport> train_model(const TrainingSource& source, const TrainOptions& options,
                                const std::filesystem::path& file, const ProgressSink& progress,
                                const std::stop_token& stop, const TrainControl& control = {});

}  // namespace engram::training
