// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/recover.h"

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "encoders/load_model.h"
#include "reports/plain/findings.h"
#include "reports/plain/text.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter =
    R"(Copies everything that can be read into a new store, even where MANIFEST.json is broken or gone. The
source is never written to; no process may write to it meanwhile. The copy lies in COPY.unfinished
until it is whole. Exit code: 0 where nothing was lost, 3 where something was, 1 where it failed.

Examples:
  engram recover robot.engram -o robot-recovered.engram
  engram recover robot.engram -o robot-recovered.engram --json | jq .entities)";

struct RecoverArguments {
  std::string source;
  std::string target;
  bool is_json = false;
};

Json entities_json(const ltm::RecoverReport& report) {
  Json entities = Json::array();
  for (const auto& [id, counts] : report.entities)
    entities.push_back({{"id", id.to_string()},
                        {"recorded_saved", counts.recorded},
                        {"recorded_lost", counts.recorded_lost},
                        {"latent_saved", counts.latent},
                        {"latent_lost", counts.latent_lost},
                        {"unsealed_saved", counts.unsealed}});
  return entities;
}

Json to_json(const ltm::RecoverReport& report, const RecoverArguments& arguments) {
  return {{"source", arguments.source},
          {"target", arguments.target},
          {"lossless", !report.has_loss()},
          {"manifest_rebuilt", report.is_rebuilt},
          {"segments_copied", report.segments_copied},
          {"segments_rewritten", report.segments_rewritten},
          {"segments_lost", report.segments_lost},
          {"models_saved", report.models},
          {"models_lost", report.models_lost},
          {"journals", report.journals},
          {"damaged_journal_places", report.damaged_places},
          {"entities", entities_json(report)},
          {"findings", reports::findings_json(report.findings)}};
}

void print_report(const ltm::RecoverReport& report, const RecoverArguments& arguments) {
  reports::print_findings(report.findings);
  reports::TextTable table({"snapshots", "recorded", "lost", "latent", "lost", "unsealed"});
  for (const auto& [id, counts] : report.entities)
    table.add({id.to_string(), reports::count_text(counts.recorded),
               reports::count_text(counts.recorded_lost), reports::count_text(counts.latent),
               reports::count_text(counts.latent_lost), reports::count_text(counts.unsealed)});
  print(table.to_string());
  print(fmt::format(
      "{}: {} segments copied, {} rewritten, {} lost; {} models, {} lost; {} journals "
      "with {} damaged places",
      arguments.target, report.segments_copied, report.segments_rewritten, report.segments_lost,
      report.models, report.models_lost, report.journals, report.damaged_places));
  print(report.has_loss() ? "Something was lost: see above." : "Nothing was lost.");
}

ExitCode run(const RecoverArguments& arguments) {
  const ltm::RecoverOptions options{
      [](const std::filesystem::path& file) { return encoders::load_model(file).status(); }};
  ProgressLine progress;
  const auto report = ltm::recover_store(arguments.source, arguments.target, options,
                                         progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(to_json(*report, arguments));
  else
    print_report(*report, arguments);
  return report->has_loss() ? ExitCode::kDoneWithLoss : ExitCode::kDone;
}

}  // namespace

void add_recover_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<RecoverArguments>();
  CLI::App* command =
      app.add_subcommand("recover", "Save what can be read of a damaged store into a new one");
  command->footer(kFooter);
  command->add_option("store", arguments->source, "Store that is damaged")->required();
  command->add_option("-o,--output", arguments->target, "New store; must not exist")->required();
  command->add_flag("--json", arguments->is_json, "As JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
