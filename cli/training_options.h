// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "cli/command.h"
#include "training/fit/trainer.h"

namespace engram::cli {

/// The options of commands that train, as they are written.
struct TrainingArguments {
  std::string budget = "2min";
  int steps = 0;  ///< Zero: the budget counts.
};

/// Adds --budget, --steps, --seed, --psnr, --width, --varied, --augmented, --augmented-share and
/// --threads. Both outlive the command.
/// `budget_of` tells whose time the budget is, `psnr_of` what the PSNR is.
void add_training_options(CLI::App& command, TrainingArguments& arguments,
                          training::TrainOptions& options, std::filesystem::path& augmented,
                          const std::string& budget_of, const std::string& psnr_of);

/// Takes over what add_training_options could not write into the options itself.
/// Errors: kInvalidArgument.
Status finish_training_options(const TrainingArguments& arguments, training::TrainOptions& options);

}  // namespace engram::cli
