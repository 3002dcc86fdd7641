// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "ltm/likeness/make_codes.h"
#include "ltm/saliency/make_saliency.h"
#include "ltm/saliency/why_salient.h"
#include "memory/model_loader.h"
#include "reports/plain/saliency_text.h"

namespace engram::cli {

namespace {

constexpr const char* kWhySalientFooter =
    R"(MOMENT is MEMORY/CORE/PROVIDER/ENTITY/TIME, or an entity, for its last snapshot. Its saliency is a
number from 0 to 1: how much would be lost without it. It is the weighted sum of seven parts: what
the snapshots around it do not tell (change), how wrong a prediction of it was (surprise), how far
it is from all before (novelty), how an action ended (outcome), speech, links that lead elsewhere,
and how often it was read. A night calculates it (engram consolidate), and --keep does at once for
all snapshots that have none yet. What has little goes first where forgetting says so (saliency in
docs/forgetting.md).

Examples:
  engram why-salient kitchen.engram Skill/Event/robot/pick
  engram why-salient kitchen.engram 'Objects/Instances/kitchen/tea_1/2026-01-01 08:00:10' --json
  engram why-salient robot.engram Vision/RGB/head/cam --keep)";

struct WhySalientArguments {
  std::string store;
  std::string moment;
  bool keeps = false;
  bool is_json = false;
};

Status explain(const WhySalientArguments& arguments, const ltm::MemoryId& id) {
  if (arguments.keeps) {
    ProgressLine progress;
    ENGRAM_RETURN_IF_ERROR(
        ltm::make_codes(arguments.store, model_loader(), {}, progress.sink(), interrupt_token())
            .status());
    const auto made =
        ltm::make_saliency(arguments.store, model_loader(), {}, progress.sink(), interrupt_token());
    progress.finish();
    ENGRAM_RETURN_IF_ERROR(made.status());
  }
  ENGRAM_ASSIGN_OR_RETURN(
      const ltm::SalientMoment told,
      ltm::why_salient(arguments.store, model_loader(), id.entity(), id.time(), interrupt_token()));
  if (arguments.is_json)
    print_json(reports::saliency_json(told));
  else
    print(reports::saliency_text(told));
  return {};
}

ExitCode run(const WhySalientArguments& arguments) {
  const auto id = ltm::MemoryId::parse(arguments.moment);
  if (!id.ok()) return wrong_usage(id.status());
  if (!id->has_entity())
    return wrong_usage(invalid_argument("'{}': needs a moment or an entity, has {} of 4 names",
                                        arguments.moment, id->names().size()));
  return done_or_failed(explain(arguments, *id));
}

}  // namespace

void add_why_salient_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<WhySalientArguments>();
  CLI::App* command = app.add_subcommand("why-salient", "Explain what a snapshot is worth");
  command->footer(kWhySalientFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("moment", arguments->moment, "A moment, or an entity for its last one")
      ->required();
  command->add_flag("--keep", arguments->keeps,
                    "Calculate and store the saliency of all snapshots that have none yet");
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
