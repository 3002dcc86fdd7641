// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "reports/eval_picture.h"
#include "reports/eval_text.h"
#include "reports/plain/text.h"
#include "training/measure/evaluate.h"

namespace engram::cli {

namespace {

constexpr const char* kEvalFooter = R"(Examples:
  engram eval robot.engram
  engram eval robot.engram --json
  engram eval robot.engram --picture eval.png

PSNR is on 8-bit RGB, range 255, images capped at 60 dB, in two conventions: the mean over the
images' PSNR, and the PSNR of the pooled squared error. Predictions start from the recorded past;
copy-last is measured on the same snapshots. "trained on": autoencoder and dynamics saw them;
"held out": the dynamics did not; "left-out recordings": neither did.
Every prediction tells a bound that its error keeps with a probability of 90 %; "within" says how
often it did. The bounds were measured on held-out snapshots: what they are worth for new ones,
left-out recordings tell.)";

struct EvalArguments {
  std::string store;
  training::EvaluateOptions options;
  std::string picture;
  bool is_json = false;
};

ExitCode run(const EvalArguments& arguments) {
  ProgressLine progress;
  const auto report =
      training::evaluate(arguments.store, arguments.options, progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json) {
    print_json(training::to_json(*report));
  } else if (report->entities.empty()) {
    print("No entity has a model: run `engram consolidate` first.");
  } else {
    for (const training::EntityEvaluation& entity : report->entities)
      reports::print_evaluation(entity);
  }
  if (!arguments.picture.empty())
    if (const Status drawn = reports::write_eval_picture(arguments.store, arguments.picture);
        !drawn.ok())
      return fail(drawn);
  return ExitCode::kDone;
}

}  // namespace

void add_eval_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<EvalArguments>();
  CLI::App* command = app.add_subcommand("eval", "Measure reconstruction and prediction");
  command->footer(kEvalFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("--entity", arguments->options.entities,
                      "Names or patterns of entities; else all with a model");
  command
      ->add_option("--max-predictions", arguments->options.max_predictions,
                   "Max number of predictions that are measured for each entity and horizon")
      ->capture_default_str();
  command->add_option("--picture", arguments->picture,
                      "Draw recorded, reconstructed and predicted images side by side (PNG)");
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
