// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "cli/command.h"
#include "training/fit/trainer.h"

namespace engram::cli {

/// The options of commands that train, unparsed.
struct TrainingArguments {
  std::string budget = "2min";
  int steps = 0;  ///< Zero: the budget decides.
};

/// Adds --budget, --steps, --seed, --psnr, --width, --varied, --augmented, --augmented-share and
/// --threads. Both arguments must outlive the command. `budget_of` and `psnr_of` complete the help
/// texts: whose time the budget is, and which PSNR is meant.
void add_training_options(CLI::App& command, TrainingArguments& arguments,
                          training::TrainOptions& options, std::filesystem::path& augmented,
                          const std::string& budget_of, const std::string& psnr_of);

/// Parses the options that add_training_options could not write into `options` itself.
/// Errors: kInvalidArgument.
Status finish_training_options(const TrainingArguments& arguments, training::TrainOptions& options);

}  // namespace engram::cli
