// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <array>

#include "cli/command.h"
#include "cli/confirm.h"
#include "cli/interrupt.h"
#include "cli/learning_module.h"
#include "cli/progress_line.h"
#include "ltm/forgetting/redact_store.h"
#include "ltm/redaction/redaction_config.h"
#include "memory/model_loader.h"
#include "reports/plain/redaction_report.h"

namespace engram::cli {

namespace {

constexpr const char* kRedactFooter =
    R"(Looks at each snapshot in the order of time, records it anew with what the detector finds taken out of
its images, and then erases the originals as "engram forget --erase" does, models that learned from
them included. Nobody may record into the store meanwhile. The same command finishes what a killed
one began. What no detector answered for stays as it is, and the exit code is then 1.

A detector is written as in a recording configuration (docs/recording.md):
  people, faces, '{faces: cascade.xml}'          best effort
  '{onnx: yolo.onnx, threshold: 0.25, classes: [0], size: 640}'
  '{program: [./find.py, --fast]}'

Examples:
  engram redact robot.engram --detector people --dry-run
  engram redact robot.engram --detector people --action fill --yes
  engram redact robot.engram 'Vision/RGB/head/cam @ until:2022-02-18T13:06:55Z' --detector faces
  engram redact robot.engram Vision --detector '{program: [./find.py]}' --timeout 10s --yes)";

struct RedactArguments {
  std::string store;
  std::vector<std::string> targets;
  std::string detector;
  std::string action = "pixelate";
  double grow = 0.2;
  std::string hold = "1s";
  std::string timeout = "30s";
  bool is_dry_run = false;
  bool is_json = false;
  bool is_confirmed = false;
};

Result<ltm::RedactionOptions> options_of(const RedactArguments& arguments) {
  ltm::RedactionOptions options;
  ENGRAM_ASSIGN_OR_RETURN(options.detector, ltm::parse_detector(arguments.detector, "--detector"));
  options.action = arguments.action == "fill"   ? ltm::RedactAction::kFill
                   : arguments.action == "drop" ? ltm::RedactAction::kDrop
                                                : ltm::RedactAction::kPixelate;
  options.grow = arguments.grow;
  ENGRAM_ASSIGN_OR_RETURN(options.hold, parse_duration(arguments.hold));
  if (auto* program = std::get_if<ltm::ProgramDetector::Options>(&options.detector)) {
    ENGRAM_ASSIGN_OR_RETURN(program->timeout, parse_duration(arguments.timeout));
  }
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return options;
}

/// Loads what codes latents anew only if the store has any.
Result<ltm::Erasures> code_anew_after_redaction(const std::filesystem::path& store,
                                                const ltm::ForgetSet& gone,
                                                const ProgressSink& progress,
                                                const std::stop_token& stop) {
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Manifest manifest, ltm::read_manifest(store));
  if (manifest.models.empty()) return ltm::Erasures();
  ENGRAM_ASSIGN_OR_RETURN(const LearningModule* module, learning_module());
  return module->code_anew(store, gone, progress, stop);
}

Status check_asking(const RedactArguments& arguments) {
  if (arguments.is_dry_run || arguments.is_confirmed) return {};
  if (arguments.is_json) return invalid_argument("redact: --json needs --yes or --dry-run");
  if (::isatty(STDIN_FILENO) == 0)
    return invalid_argument("redact: nobody to ask, as the input is no terminal; needs --yes");
  return {};
}

ExitCode run_redaction(const RedactArguments& arguments) {
  if (const Status status = check_asking(arguments); !status.ok()) return wrong_usage(status);
  const auto options = options_of(arguments);
  if (!options.ok()) return wrong_usage(options.status());
  if (!arguments.is_dry_run && !arguments.is_confirmed &&
      !is_confirmed(
          fmt::format("Redact what '{}' finds in '{}'? The originals cannot be brought back.",
                      arguments.detector, arguments.store)))
    return fail(cancelled("redact: nothing was changed"));
  ProgressLine progress;
  const auto report = ltm::redact_store({.store = arguments.store,
                                         .targets = arguments.targets,
                                         .options = *options,
                                         .is_dry_run = arguments.is_dry_run,
                                         .loader = model_loader(),
                                         .code_anew = code_anew_after_redaction,
                                         .progress = progress.sink(),
                                         .stop = interrupt_token()});
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(report->to_json());
  else
    reports::print_redaction(*report, arguments.is_dry_run);
  const ltm::EntityRedaction total = report->total();
  if (total.unanswered + total.unreadable == 0) return ExitCode::kDone;
  return fail(unavailable(
      "store '{}': {} snapshots are as they were, since the detector gave no answer for {} and {} "
      "have images in a form in which no detector looks",
      arguments.store, total.unanswered + total.unreadable, total.unanswered, total.unreadable));
}

}  // namespace

void add_redact_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<RedactArguments>();
  CLI::App* command =
      app.add_subcommand("redact", "Make people or other things unrecognisable in a store");
  command->footer(kRedactFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("what", arguments->targets, "IDs, or queries NAMES @ SELECTOR; else all");
  command->add_option("--detector", arguments->detector, "What finds them, see below")->required();
  command
      ->add_option("--action", arguments->action,
                   "pixelate, fill with zeros, or drop the whole snapshot")
      ->check(CLI::IsMember(std::vector<std::string>{"pixelate", "fill", "drop"}))
      ->capture_default_str();
  command->add_option("--grow", arguments->grow, "By how much of its size a box grows to each side")
      ->capture_default_str();
  command->add_option("--hold", arguments->hold, "How long a box holds after it was last seen")
      ->check(duration_text())
      ->capture_default_str();
  command->add_option("--timeout", arguments->timeout, "How long a program may take for an image")
      ->check(duration_text())
      ->capture_default_str();
  command->add_flag("--dry-run", arguments->is_dry_run, "Only say what would be redacted");
  command->add_flag("--json", arguments->is_json, "What was done as JSON");
  command->add_flag("-y,--yes", arguments->is_confirmed, "Do not ask");
  command->callback([arguments, &exit_code] { exit_code = run_redaction(*arguments); });
}

}  // namespace engram::cli
