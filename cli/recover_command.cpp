// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/recover.h"

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/learning_module.h"
#include "cli/progress_line.h"
#include "ltm/core/log.h"
#include "ltm/recall/index_store.h"
#include "memory/model_loader.h"
#include "reports/plain/recover_text.h"

namespace engram::cli {

namespace {

constexpr const char* kRecoverFooter =
    R"(Copies everything that can be read into a new store, even where MANIFEST.json is broken or gone. The
source is never written to; no process may write to it meanwhile. The copy lies in COPY.unfinished
until it is whole. Exit code: 0 where nothing was lost, 3 where something was, 1 where it failed.

Examples:
  engram recover robot.engram -o robot-recovered.engram
  engram recover robot.engram -o robot-mended.engram --future   # a wrong clock had made snapshots
  engram recover robot.engram -o robot-recovered.engram --json | jq .entities)";

struct RecoverArguments {
  std::string source;
  std::string target;
  std::string future;  ///< How far ahead of the clock is too far; empty: nothing is.
  bool is_json = false;
};

ExitCode run(const RecoverArguments& arguments) {
  if (const Status ready = ready_for_models(arguments.source); !ready.ok()) return fail(ready);
  ltm::RecoverOptions options;
  options.test_model = test_model;
  if (!arguments.future.empty()) {
    const auto ahead = parse_duration(arguments.future);
    if (!ahead.ok()) return fail(ahead.status());
    options.latest = system_now() + *ahead;
  }
  ProgressLine progress;
  const auto report = ltm::recover_store(arguments.source, arguments.target, options,
                                         progress.sink(), interrupt_token());
  if (report.ok()) {
    // Indexes of segments that were not copied whole are made anew; answers do without them.
    const auto indexed =
        ltm::index_store(arguments.target, model_loader(), {}, progress.sink(), interrupt_token());
    if (!indexed.ok())
      log::warning("places and links have no index: {}", indexed.status().message());
  }
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(reports::recover_json(*report, arguments.source, arguments.target));
  else
    reports::print_recovered(*report, arguments.target);
  return report->has_loss() ? ExitCode::kDoneWithLoss : ExitCode::kDone;
}

}  // namespace

void add_recover_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<RecoverArguments>();
  CLI::App* command =
      app.add_subcommand("recover", "Save what can be read of a damaged store into a new one");
  command->footer(kRecoverFooter);
  command->add_option("store", arguments->source, "Store that is damaged")->required();
  command->add_option("-o,--out", arguments->target, "New store; must not exist")->required();
  command
      ->add_flag(
          "--future{1h}", arguments->future,
          "Leave out what lies more than 1h ahead of the clock; --future=5min: more than that")
      ->check(duration_text());
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
