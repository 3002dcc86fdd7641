// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/store_check.h"

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/learning_module.h"
#include "cli/progress_line.h"
#include "reports/plain/findings.h"

namespace engram::cli {

namespace {

constexpr const char* kCheckFooter =
    R"(Reads the whole store and changes nothing; a writer may go on meanwhile. Exit code: 0 where all is
well, 3 where data is damaged or lost, 1 where there is no store that this program reads. Notes are
worth knowing and cost nothing: left-overs of killed processes, links to entities elsewhere.

Examples:
  engram check robot.engram
  engram check robot.engram --deep
  engram check robot.engram --json | jq '.findings[] | select(.severity == "fault")')";

struct CheckArguments {
  std::string store;
  bool is_deep = false;
  bool is_json = false;
};

ExitCode run(const CheckArguments& arguments) {
  if (const Status ready = ready_for_models(arguments.store); !ready.ok()) return fail(ready);
  const ltm::CheckOptions options{arguments.is_deep, test_model};
  ProgressLine progress;
  const auto report =
      ltm::check_store(arguments.store, options, progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(reports::check_json(*report, arguments.store));
  else
    reports::print_check(*report, arguments.store);
  return report->is_clean() ? ExitCode::kDone : ExitCode::kDoneWithLoss;
}

}  // namespace

void add_check_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = app.add_subcommand("check", "Verify every checksum of a store");
  command->footer(kCheckFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_flag("--deep", arguments->is_deep, "Decode every image, too");
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
