// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "cli/text.h"
#include "datasets/export.h"
#include "encoders/load_model.h"
#include "ltm/core/log.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter = R"(Formats:
  jsonl   snapshots.jsonl: one snapshot per line, with all its data, metadata and source
  csv     <entity>.csv: a line per instance, a column per number; where the numbers change, a
          further table <entity>#2.csv
  png     <entity>/<member>/<time>.png, further instances as <time>#1.png
  mp4     <entity>/<member>.mp4: H.264, playable while it loads; a gap of an hour or another size
          begins <member>.part2.mp4
  armarx  <entity>/<time in microseconds>/<instance>/<member>.png and data.json with all else
<entity> is Memory/Core/Provider/Entity. In names / % # leading dots and control characters are %XX.

Examples:
  engram export robot.engram --to jsonl -o out
  engram export robot.engram 'Vision/.*/.*/cam @ last:10s' --to mp4 -o videos
  engram export robot.engram 'RobotState @ all' --to csv -o tables)";

struct ExportArguments {
  std::string store;
  std::string query = "@ all";
  std::string format;
  std::string directory;
  std::string prefer = "recorded";
  datasets::ExportOptions options;
  bool is_forced = false;
  bool is_json = false;
};

Json report_json(const datasets::ExportReport& report) {
  Json left_out = Json::object();
  for (const auto& [what, count] : report.not_carried) left_out[what] = count;
  return {{"snapshots", report.snapshots},
          {"instances", report.instances},
          {"files", report.files},
          {"bytes", report.bytes},
          {"not_carried", std::move(left_out)}};
}

void print_report(const datasets::ExportReport& report, const ExportArguments& arguments) {
  print(fmt::format("{} snapshots with {} instances: {} files, {}, below {}",
                    count_text(report.snapshots), count_text(report.instances),
                    count_text(report.files), bytes_text(static_cast<double>(report.bytes)),
                    arguments.directory));
  if (!report.not_carried.empty())
    print(fmt::format("Left out, as {} does not carry it:", arguments.format));
  for (const auto& [what, count] : report.not_carried)
    print(fmt::format("  {:>10}  {}", count_text(count), what));
}

ExitCode run(const ExportArguments& arguments) {
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
  ltm::Recall recall(std::move(*reader), encoders::load_model);
  ltm::Recall::Options options;
  options.prefer =
      arguments.prefer == "latent" ? ltm::Recall::Prefer::kLatent : ltm::Recall::Prefer::kRecorded;
  ProgressLine progress;
  const Status done = datasets::export_snapshots(recall, *query, options, **sink, progress.sink(),
                                                 interrupt_token());
  progress.finish();
  if (!done.ok() && done.code() != StatusCode::kCancelled) return fail(done);
  if (arguments.is_json)
    print_json(report_json((*sink)->report()));
  else
    print_report((*sink)->report(), arguments);
  if (!done.ok()) return fail(done);
  if (damaged == 0) return ExitCode::kDone;
  log::warning("store '{}': {} damaged places in its journals; what was there is not exported",
               arguments.store, damaged);
  return ExitCode::kDoneWithLoss;
}

}  // namespace

void add_export_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "Write snapshots in formats of other programs");
  command->footer(kFooter);
  command->add_option("store", arguments->store, "Store")->required();
  command->add_option("query", arguments->query, "NAMES @ SELECTOR, see 'engram query --help'")
      ->capture_default_str();
  command->add_option("--to", arguments->format, "Format")
      ->required()
      ->check(CLI::IsMember(std::vector<std::string>(datasets::kExportFormats.begin(),
                                                     datasets::kExportFormats.end())));
  command->add_option("-o,--out", arguments->directory, "Directory, made where it is missing")
      ->required();
  command->add_flag("--force", arguments->is_forced, "Write into a directory that has files");
  command
      ->add_option("--rate", arguments->options.rate_hz,
                   "mp4: images per second; 0: the times of the snapshots")
      ->capture_default_str();
  command->add_flag("--444", arguments->options.keeps_chroma,
                    "mp4: colour at full resolution; browsers do not play it");
  command->add_option("--crf", arguments->options.crf, "mp4: quality, 0 (best) to 51")
      ->capture_default_str();
  command->add_option("--prefer", arguments->prefer, "Which form is taken where both are there")
      ->check(CLI::IsMember({"recorded", "latent"}))
      ->capture_default_str();
  command->add_flag("--json", arguments->is_json, "What was written as JSON on stdout");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
