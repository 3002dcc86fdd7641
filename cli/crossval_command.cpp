// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "cli/training_options.h"
#include "ltm/core/log.h"
#include "reports/crossval_text.h"
#include "reports/plain/text.h"
#include "training/measure/crossval.h"

namespace engram::cli {

namespace {

constexpr const char* kCrossvalFooter = R"(Examples:
  engram crossval robot.engram --entity Vision/RGB/head/cam --training 5m
  engram crossval robot.engram --entity Vision/RGB/head/cam --variants all --training 2m
  engram crossval robot.engram --entity Vision/RGB/head/cam --psnr 34 --fold 2 --json
  engram crossval robot.engram --entity Vision/RGB/head/cam --spacing 200ms --training 20m --bound 30

A recording ends where there is a gap. For each, a model of each variant is trained on all others
for --training, and reconstructs and predicts the one that was left out, which is told on stderr as soon
as it is known; nothing is published. With
--spacing, snapshots so far apart are measured, and those between them are trained on too. PSNR is
the mean over images / of the pooled error. Variants: "rate" trains for few bytes, "ae" for small
errors alone, "vae" and "wae" for latents like a Gaussian. "copy-last" repeats the last snapshot,
"linear" draws a straight line through the last two, "flow" moves pixels on as they moved.)";

struct CrossvalArguments {
  std::string store;
  training::CrossvalOptions options;
  std::vector<std::string> variants{"rate"};
  TrainingArguments learning;
  std::string spacing = "0s";
  bool is_json = false;
};

/// Parses names such as "rate,vae" or "all".
Result<std::vector<encoders::TrainingVariant>> variants_of(const std::vector<std::string>& names) {
  std::vector<encoders::TrainingVariant> variants;
  for (const std::string& name : names) {
    if (name == "all") {
      variants.assign(encoders::kTrainingVariants.begin(), encoders::kTrainingVariants.end());
      continue;
    }
    ENGRAM_ASSIGN_OR_RETURN(variants.emplace_back(), encoders::training_variant_of(name));
  }
  return variants;
}

ExitCode run(CrossvalArguments& arguments) {
  // Everything is checked before the first fold: it trains for the whole budget, and a wrong word
  // must not be found after that.
  if (const Status status = finish_training_options(arguments.learning, arguments.options.train);
      !status.ok())
    return wrong_usage(status);
  const auto spacing = parse_duration(arguments.spacing);
  if (!spacing.ok()) return wrong_usage(spacing.status());
  arguments.options.spacing = *spacing;
  auto variants = variants_of(arguments.variants);
  if (!variants.ok()) return wrong_usage(variants.status());
  arguments.options.variants = *std::move(variants);
  if (const Status status = arguments.options.validate(); !status.ok()) return wrong_usage(status);
  ProgressLine progress;
  // All folds together may take hours, so each is told as soon as it is known. It goes to stderr,
  // because stdout has the report alone.
  const auto tell = [&](const training::CrossvalFold& fold, size_t number) {
    progress.finish();
    log::write(log::Level::kInfo, reports::fold_text(fold, number));
  };
  const auto report = training::crossval(arguments.store, arguments.options, progress.sink(),
                                         interrupt_token(), tell);
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(training::to_json(*report));
  else
    print(reports::crossval_text(*report));
  return ExitCode::kDone;
}

}  // namespace

void add_crossval_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<CrossvalArguments>();
  training::TrainOptions& train = arguments->options.train;
  CLI::App* command =
      app.add_subcommand("crossval", "Leave each recording out of training, and measure it");
  command->footer(kCrossvalFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("--entity", arguments->options.entity, "Entity")->required();
  add_training_options(*command, arguments->learning, train, arguments->options.augmented,
                       "--training", "each fold and variant", "Mean PSNR of images to aim at, dB");
  command
      ->add_option("--fold", arguments->options.folds,
                   "Leave out only these recordings, by number from 1 on; else each")
      ->delimiter(',');
  command
      ->add_option("--spacing", arguments->spacing,
                   "Time between snapshots that are measured; 0s: all are")
      ->check(duration_text())
      ->capture_default_str();
  command
      ->add_option("--max-horizon", arguments->options.max_horizon,
                   "Predictions are measured of the next so many snapshots, 2 to 100")
      ->capture_default_str();
  command
      ->add_option("--variants,--variant", arguments->variants,
                   "What latents are trained for: some of rate, ae, vae and wae; or all")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--refine", arguments->options.refine_steps,
                   "Steps that search better latents for each block that is measured")
      ->capture_default_str();
  command->add_option(
      "--bound", arguments->options.bound_db,
      "Measures latents with residuals where images are below this PSNR, dB, beside "
      "latents alone");
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
