// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "datasets/export.h"
#include "datasets/formats.h"
#include "datasets/vault/vault_export.h"
#include "ltm/core/log.h"
#include "memory/model_loader.h"
#include "reports/plain/export_text.h"
#include "reports/plain/vault_text.h"

namespace engram::cli {

namespace {

constexpr const char* kExportFooter = R"(Formats:
  jsonl   snapshots.jsonl: one snapshot per line, with all its data, metadata and source
  csv     <entity>.csv: a line per instance, a column per number; where the numbers change, a
          further table <entity>#2.csv
  png     <entity>/<member>/<time>.png, further instances as <time>#1.png
  mp4     <entity>/<member>.mp4: H.264, playable while it loads; a gap of an hour or another size
          begins <member>.part2.mp4
  armarx  <entity>/<time in microseconds>/<instance>/<member>.png and data.json with all else
<entity> is Memory/Core/Provider/Entity. In names / % # leading dots and control characters are %XX.
Whole recordings, which "engram import --from" reads too, are one file or folder (docs/formats.md); what
the format cannot hold is listed before anything is written, with --dry-run without writing.
A vault is an encrypted copy that goes on where the last export ended; 'engram vault --help'.

Examples:
  engram export robot.engram --to jsonl -o out
  engram export robot.engram 'Vision/.*/.*/cam @ last:10s' --to mp4 -o videos
  engram export robot.engram 'RobotState @ all' --to csv -o tables
  engram export robot.engram --to vault -o /mnt/nas/robot.vault --keys ~/robot.keys)";

constexpr std::string_view kVaultName = "vault";

struct ExportArguments {
  std::string store;
  std::string query = "@ all";
  std::string format;
  std::string directory;
  std::string keys;
  std::string prefer = "recorded";
  datasets::ExportOptions options;
  datasets::WritingOptions writing;
  bool is_dry = false;
  bool is_forced = false;
  bool is_json = false;
};

ltm::Recall::Prefer prefer_of(const ExportArguments& arguments) {
  return arguments.prefer == "latent" ? ltm::Recall::Prefer::kLatent
                                      : ltm::Recall::Prefer::kRecorded;
}

ExitCode warn_of_damage(const ExportArguments& arguments, uint64_t places) {
  log::warning("store '{}': {} damaged places in its journals; what was there is not exported",
               arguments.store, places);
  return ExitCode::kDoneWithLoss;
}

/// The names of formats with files per entity, and of formats of whole recordings that can be
/// written.
std::vector<std::string> format_names() {
  std::vector<std::string> names(datasets::kExportFormats.begin(), datasets::kExportFormats.end());
  for (const auto& format : datasets::all_recording_formats())
    if (format->can_write()) names.emplace_back(format->name());
  names.emplace_back(kVaultName);
  return names;
}

/// Writes one file or folder in a format of whole recordings.
Result<datasets::ExportReport> write_recording(const ExportArguments& arguments,
                                               const datasets::RecordingFormat& format,
                                               ltm::Recall& recall, const ltm::Query& query) {
  datasets::WritingOptions options = arguments.writing;
  options.recall.prefer = prefer_of(arguments);
  ENGRAM_ASSIGN_OR_RETURN(const auto not_held, format.not_held(recall, query, options));
  for (const auto& [what, count] : not_held)
    log::warning("{} does not hold: {} ({} entities)", format.name(), what, count);
  if (arguments.is_dry) {
    datasets::ExportReport report;
    report.not_carried = not_held;
    return report;
  }
  std::error_code error;
  if (std::filesystem::exists(arguments.directory, error))
    // A recording is one file or folder as a whole, so it is never merged into an old one.
    return already_exists("'{}' is there already: needs a new place", arguments.directory);
  ProgressLine progress;
  auto report =
      format.write(recall, query, arguments.directory, options, progress.sink(), interrupt_token());
  progress.finish();
  return report;
}

ExitCode run_recording(const ExportArguments& arguments, const datasets::RecordingFormat& format) {
  const auto query = ltm::Query::parse(arguments.query);
  if (!query.ok()) return wrong_usage(query.status());
  auto reader = ltm::StoreReader::open(arguments.store);
  if (!reader.ok()) return fail(reader.status());
  const uint64_t damaged = (*reader)->damaged_places();
  ltm::Recall recall(std::move(*reader), model_loader());
  const auto report = write_recording(arguments, format, recall, *query);
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(reports::export_json(*report));
  else
    reports::print_export(*report, arguments.format, arguments.directory);
  return damaged == 0 ? ExitCode::kDone : warn_of_damage(arguments, damaged);
}

/// Adds what is new to an encrypted copy.
ExitCode run_vault(const ExportArguments& arguments) {
  if (arguments.keys.empty())
    return wrong_usage(invalid_argument("export: a vault needs --keys, a file outside of it"));
  const auto query = ltm::Query::parse(arguments.query);
  if (!query.ok()) return wrong_usage(query.status());
  auto reader = ltm::StoreReader::open(arguments.store);
  if (!reader.ok()) return fail(reader.status());
  const uint64_t damaged = (*reader)->damaged_places();
  ltm::Recall recall(std::move(*reader), model_loader());
  datasets::vault::VaultExportOptions options;
  options.recall.prefer = prefer_of(arguments);
  options.takes_other_store = arguments.is_forced;
  options.is_dry = arguments.is_dry;
  ProgressLine progress;
  const auto report =
      datasets::vault::export_to_vault(recall, *query, {arguments.directory, arguments.keys},
                                       options, progress.sink(), interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(reports::vault_export_json(*report));
  else
    reports::print_vault_export(*report, arguments.directory, arguments.is_dry);
  if (damaged > 0) return warn_of_damage(arguments, damaged);
  return report->unread.empty() ? ExitCode::kDone : ExitCode::kDoneWithLoss;
}

ExitCode run(const ExportArguments& arguments) {
  if (arguments.format == kVaultName) return run_vault(arguments);
  if (!arguments.keys.empty())
    return wrong_usage(
        invalid_argument("export: --keys is for a vault, found --to {}", arguments.format));
  if (const auto format = datasets::find_recording_format(arguments.format); format.ok())
    return run_recording(arguments, **format);
  const auto query = ltm::Query::parse(arguments.query);
  if (!query.ok()) return wrong_usage(query.status());
  if (const Status valid = arguments.options.validate(); !valid.ok()) return wrong_usage(valid);
  auto reader = ltm::StoreReader::open(arguments.store);
  if (!reader.ok()) return fail(reader.status());
  const uint64_t damaged = (*reader)->damaged_places();
  if (const Status ready = datasets::prepare_export(arguments.directory, arguments.is_forced);
      !ready.ok())
    return fail(ready.code() == StatusCode::kAlreadyExists && !arguments.is_forced
                    ? Status(ready.code(), ready.message() + "; --force writes into it")
                    : ready);
  const auto sink =
      datasets::make_snapshot_sink(arguments.format, arguments.directory, arguments.options);
  if (!sink.ok()) return wrong_usage(sink.status());
  ltm::Recall recall(std::move(*reader), model_loader());
  ltm::Recall::Options options;
  options.prefer = prefer_of(arguments);
  ProgressLine progress;
  const Status done = datasets::export_snapshots(recall, *query, options, **sink, progress.sink(),
                                                 interrupt_token());
  progress.finish();
  // After Ctrl-C the report still says what was written.
  if (!done.ok() && done.code() != StatusCode::kCancelled) return fail(done);
  if (arguments.is_json)
    print_json(reports::export_json((*sink)->report()));
  else
    reports::print_export((*sink)->report(), arguments.format, arguments.directory);
  if (!done.ok()) return fail(done);
  return damaged == 0 ? ExitCode::kDone : warn_of_damage(arguments, damaged);
}

}  // namespace

void add_export_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "Write snapshots in formats of other programs");
  command->footer(kExportFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("query", arguments->query, "NAMES @ SELECTOR, see 'engram query --help'")
      ->capture_default_str();
  command->add_option("--to", arguments->format, "Format")
      ->required()
      ->check(CLI::IsMember(format_names()));
  command
      ->add_option("-o,--out", arguments->directory,
                   "Directory, made where it is missing; whole recordings: the new file")
      ->required();
  command->add_option("--keys", arguments->keys,
                      "vault: the file with its keys, outside of it; made where it is missing");
  command->add_flag("--force", arguments->is_forced,
                    "Write into a directory that has files; vault: that is of another store");
  command
      ->add_option("--rate", arguments->options.rate_hz,
                   "mp4: images per second; 0: the times of the snapshots")
      ->capture_default_str();
  command->add_flag("--444", arguments->options.keeps_chroma,
                    "mp4: colour at full resolution; browsers do not play it");
  command->add_option("--crf", arguments->options.crf, "mp4: quality, 0 (best) to 51")
      ->capture_default_str();
  command
      ->add_option(
          "--jpeg-quality", arguments->writing.jpeg_quality,
          "Whole recordings: images as JPEG of this quality where the format can; 0: without "
          "loss")
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  command->add_flag("--dry-run", arguments->is_dry,
                    "Whole recordings: only tell what the format cannot hold; vault: what is new");
  command->add_option("--prefer", arguments->prefer, "Which form is taken where both are there")
      ->check(CLI::IsMember({"recorded", "latent"}))
      ->capture_default_str();
  command->add_flag("--json", arguments->is_json, "What was written as JSON on stdout");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
