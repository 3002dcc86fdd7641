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

/// A trained model, with its weights rounded as in a model file, and the report of its training.
struct FittedModel {
  std::shared_ptr<encoders::DeepModel> model;
  TrainReport training;
};

/// Trains a model on `source`.
///
/// Errors: kInvalidArgument if the values cannot be tensors; kCancelled on `stop`;
/// kResourceExhausted if memory runs out, or the time of control.pace while the robot is busy; the
/// errors of source.read.
/// Threading: one training at a time per process, because it uses LibTorch's global random
/// generator and threads.
Result<FittedModel> fit_model(const TrainingSource& source, const TrainOptions& options,
                              const ProgressSink& progress, const std::stop_token& stop,
                              const TrainControl& control = {});

/// Trains a model and writes it to `file`, which must not exist.
/// Errors: as for fit_model; the errors of writing.
/// Threading: as for fit_model.
Result<TrainReport> train_model(const TrainingSource& source, const TrainOptions& options,
                                const std::filesystem::path& file, const ProgressSink& progress,
                                const std::stop_token& stop, const TrainControl& control = {});

}  // namespace engram::training
