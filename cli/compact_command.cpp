// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "ltm/core/config.h"
#include "ltm/core/log.h"
#include "ltm/recall/access_log.h"
#include "ltm/recall/index_store.h"
#include "ltm/saliency/pending_saliency.h"
#include "ltm/store/rewrite.h"
#include "memory/model_loader.h"
#include "reports/plain/compact_text.h"

namespace engram::cli {

namespace {

constexpr const char* kCompactFooter =
    R"(Joins small segment files that follow each other and leaves out what updates replaced. Runs beside
a live writer and beside readers; killed at any moment, nothing is lost.

Examples:
  engram compact robot.engram
  engram compact robot.engram --segment-size 512MiB)";

struct CompactArguments {
  std::string store;
  std::string segment_size = "128MiB";
  bool is_json = false;
};

/// Parses a size as configuration files write it.
Result<uint64_t> parse_bytes(const std::string& text) {
  // Other characters, such as quotes and line breaks, would be YAML syntax.
  if (text.empty() || text.find_first_not_of("0123456789.kMGTiB") != std::string::npos)
    return invalid_argument("--segment-size: found '{}', needs a size as in 128MiB", text);
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue file,
                          ConfigValue::parse("--segment-size: " + text, "arguments"));
  ENGRAM_ASSIGN_OR_RETURN(ConfigMap map, file.map());
  ENGRAM_ASSIGN_OR_RETURN(const ConfigValue value, map.require("--segment-size"));
  return value.bytes();
}

/// Segments that were joined have no index of places and links yet.
void index_places(const std::string& store) {
  const auto indexed = ltm::index_store(store, model_loader(), {}, {}, interrupt_token());
  if (!indexed.ok()) log::warning("places and links have no index: {}", indexed.status().message());
}

/// What snapshots are worth goes into the segments that they are joined to.
Result<ltm::RewriteReport> compact(const std::string& store, const ltm::CompactOptions& options,
                                   const ProgressSink& progress) {
  ENGRAM_ASSIGN_OR_RETURN(const auto saliency, ltm::KeptSaliency::read(store));
  return saliency.carry_over(
      store, [&] { return ltm::compact(store, options, progress, interrupt_token()); });
}

ExitCode run(const CompactArguments& arguments) {
  ltm::CompactOptions options;
  const auto bytes = parse_bytes(arguments.segment_size);
  if (!bytes.ok()) return wrong_usage(bytes.status());
  options.segment_bytes = *bytes;
  if (const Status status = options.validate(); !status.ok()) return wrong_usage(status);
  ProgressLine progress;
  const auto report = compact(arguments.store, options, progress.sink());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (const Status status = ltm::merge_accesses(arguments.store); !status.ok())
    log::warning("access logs stay as they are: {}", status.message());
  if (!report->is_cancelled) index_places(arguments.store);
  if (arguments.is_json)
    print_json(reports::compact_json(*report));
  else
    print(reports::compact_text(*report));
  if (report->is_cancelled) return fail(cancelled("compact was stopped; what was joined stays so"));
  return ExitCode::kDone;
}

}  // namespace

void add_compact_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<CompactArguments>();
  CLI::App* command = app.add_subcommand("compact", "Join small segment files");
  command->footer(kCompactFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("--segment-size", arguments->segment_size, "Up to which segments grow")
      ->capture_default_str();
  command->add_flag("--json", arguments->is_json, "Report as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
