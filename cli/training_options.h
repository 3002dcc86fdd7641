// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "cli/command.h"
#include "training/fit/trainer.h"

namespace engram::cli {

/// The options of commands that train, unparsed.
struct TrainingArguments {
  std::string time = "2min";
  int steps = 0;  ///< Zero: the time decides.
};

/// Adds the option of the time, --steps, --seed, --psnr, --width, --varied, --augmented,
/// --augmented-share and --threads. Both arguments must outlive the command. `time_option` is the
/// name of the option that takes the time of training. `time_of` and `psnr_of` complete the help
/// texts: whose time it is, and which PSNR is meant.
void add_training_options(CLI::App& command, TrainingArguments& arguments,
                          training::TrainOptions& options, std::filesystem::path& augmented,
                          const std::string& time_option, const std::string& time_of,
                          const std::string& psnr_of);

/// Parses the options that add_training_options could not write into `options` itself.
/// Errors: kInvalidArgument.
Status finish_training_options(const TrainingArguments& arguments, training::TrainOptions& options);

}  // namespace engram::cli
