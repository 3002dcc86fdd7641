// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "cli/text.h"
#include "cli/training_options.h"
#include "training/crossval.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter = R"(Examples:
  engram crossval robot.engram --entity Vision/RGB/head/cam --budget 5m
  engram crossval robot.engram --entity Vision/RGB/head/cam --psnr 34 --folds 1 --json

A recording ends where there is a gap. For each, a model is trained on all others for --budget, and
reconstructs and predicts the one that was left out; nothing is published. PSNR is the mean over
images / of the pooled error. "copy-last" repeats the last snapshot, "linear" draws a straight line
through the last two.)";

struct CrossvalArguments {
  std::string store;
  training::CrossvalOptions options;
  TrainingArguments learning;
  size_t folds = 0;
  bool is_json = false;
};

std::string quality_text(const training::Quality& quality) {
  if (quality.images > 0)
    return fmt::format("{:.2f} / {:.2f}", quality.mean_psnr_db, quality.pooled_psnr_db);
  return number_text(quality.rmse);
}

std::vector<std::string> fold_row(const std::string& name, const training::CrossvalFold& fold) {
  std::vector<std::string> row{name,
                               count_text(fold.snapshots),
                               fmt::format("{:.0f}", fold.trained_bytes),
                               quality_text(fold.trained),
                               fmt::format("{:.0f}", fold.left_out_bytes),
                               quality_text(fold.left_out)};
  for (size_t ahead = 0; ahead < 2; ++ahead)
    for (size_t way = 0; way < training::kPredictings; ++way)
      row.push_back(quality_text(fold.prediction[way][ahead]));
  return row;
}

void print_report(const training::CrossvalReport& report) {
  print(report.entity.to_string());
  std::vector<std::string> head{"left out", "snapshots",  "B trained",
                                "trained",  "B left out", "left out"};
  for (const char* ahead : {"next", "over-next"})
    for (size_t way = 0; way < training::kPredictings; ++way)
      head.push_back(
          fmt::format("{}: {}", ahead, to_string(static_cast<training::Predicting>(way))));
  TextTable table(head);
  for (const training::CrossvalFold& fold : report.folds)
    table.add(fold_row(engram::to_string(fold.first), fold));
  table.add(fold_row("all", report.all));
  print(table.to_string("  "));
  print(fmt::format("  a model takes {} on average, beside the bytes",
                    bytes_text(static_cast<double>(report.all.model_bytes))));
}

ExitCode run(CrossvalArguments& arguments) {
  if (const Status status = finish_training_options(arguments.learning, arguments.options.train);
      !status.ok())
    return wrong_usage(status);
  if (arguments.folds > 0) arguments.options.most_folds = arguments.folds;
  if (const Status status = arguments.options.validate(); !status.ok()) return wrong_usage(status);
  ProgressLine progress;
  const auto report =
      training::crossval(arguments.store, arguments.options, progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(training::to_json(*report));
  else
    print_report(*report);
  return ExitCode::kDone;
}

}  // namespace

void add_crossval_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<CrossvalArguments>();
  training::TrainOptions& train = arguments->options.train;
  CLI::App* command =
      app.add_subcommand("crossval", "Leave each recording out of training, and measure it");
  command->footer(kFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("--entity", arguments->options.entity, "Entity")->required();
  add_training_options(*command, arguments->learning, train, "each fold",
                       "Mean PSNR of images to aim at, dB");
  command->add_option("--folds", arguments->folds, "Only so many of the first recordings; 0: all")
      ->capture_default_str();
  command
      ->add_option("--refine", arguments->options.refine_steps,
                   "Steps that search better latents for each block that is measured")
      ->capture_default_str();
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
