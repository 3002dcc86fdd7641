// SPDX-License-Identifier: Apache-2.0
#include "cli/training_options.h"

#include "ltm/core/time.h"

namespace engram::cli {

void add_training_options(CLI::App& command, TrainingArguments& arguments,
                          training::TrainOptions& options, std::filesystem::path& augmented,
                          const std::string& time_option, const std::string& time_of,
                          const std::string& psnr_of) {
  command.add_option(time_option, arguments.time, "Training time of " + time_of)
      ->check(duration_text())
      ->capture_default_str();
  command.add_option("--steps", arguments.steps,
                     "Optimiser steps instead of a time: same seed, same model");
  command.add_option("--seed", options.seed, "Seed of all chance")->capture_default_str();
  command.add_option("--psnr", options.psnr_db, psnr_of)->capture_default_str();
  command
      .add_option("--width", options.width,
                  "Features of the networks, a multiple of 16; 0: by how much there is")
      ->capture_default_str();
  command
      .add_option("--varied", options.varied_share,
                  "Share of training on images as another view would show them, where there are "
                  "several: more carries over to new places, less knows old ones better")
      ->capture_default_str();
  command.add_option("--augmented", augmented,
                     "Store that 'engram augment' made of this one: trained on too, never encoded");
  command
      .add_option("--augmented-share", options.augmented_share,
                  "Share of training on augmented snapshots")
      ->capture_default_str();
  command.add_option("--threads", options.threads, "Threads of the networks")
      ->capture_default_str();
}

Status finish_training_options(const TrainingArguments& arguments,
                               training::TrainOptions& options) {
  ENGRAM_ASSIGN_OR_RETURN(options.budget, parse_duration(arguments.time));
  if (arguments.steps > 0) options.steps = arguments.steps;
  return {};
}

}  // namespace engram::cli
