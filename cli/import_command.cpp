// SPDX-License-Identifier: Apache-2.0
#include <set>

#include "cli/command.h"
#include "cli/import_options.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "datasets/recordings/import_recording.h"
#include "datasets/vault/vault_import.h"
#include "datasets/vault/vault_mark.h"
#include "ltm/core/log.h"
#include "ltm/core/printable.h"
#include "ltm/likeness/sealed_indexer.h"
#include "reports/plain/import_report.h"
#include "reports/plain/vault_text.h"

namespace engram::cli {

namespace {

constexpr const char* kImportFooter = R"(Examples:
  engram import --from recording.mcap --dry-run
  engram import --from recording.mcap robot.engram
  engram import --from /mnt/nas/robot.vault --keys ~/robot.keys robot.engram
  engram import --from demos.hdf5 --episodes demo_0,demo_1 --start '2022-02-18 13:00' robot.engram
  engram import --video V.mp4 --table T.csv --entity Vision/RGB/head/cam \
      --state-entity RobotState/Proprioception/robot/joints robot.engram
  engram import --video V.mp4 --entity Vision/RGB/head/cam --size 128x128 --rate 5 \
      --start '2022-02-18 13:06:56' robot.engram
  engram import --video V.mp4 --entity Vision/RGB/head/cam --types camera.xml \
      --type Vision/RGB=robot::View robot.engram
  engram import --video V.mp4 --entity Vision/RGB/head/cam --preset small robot.engram
  engram import --print-preset balanced > mine.yaml
  engram import --video V.mp4 --entity Vision/RGB/head/cam --config mine.yaml robot.engram

Recordings (--from) come in whole, nothing is thinned unless --rate, --preset or --config say so; what
a format holds that a memory cannot is counted at the end (docs/formats.md).

A vault ('engram vault --help') comes back as it was exported, so nothing else can be chosen. Times that
the store has already stay as they are, and an import that was stopped goes on.

Of a video every frame becomes a snapshot {"image", "state"}, every row of the table a snapshot of its
columns ("a.b" becomes {"a": {"b": ...}}) with a link to its image; each links to the nearest of
the other that came in. With --type values are stored as a segment's type has them, and refused where
they break it. Without --start the recording begins when the video says it was made, else
at 1970-01-01. Entities are filtered to --rate each; --all keeps everything. With --config or
--preset filters and codecs are those of the configuration (docs/recording.md).)";

Result<ltm::Recorder> open_recorder(const ImportArguments& arguments,
                                    const ltm::Recorder::Options& recording,
                                    const std::vector<DeclaredType>& types) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::Recorder recorder, ltm::Recorder::open(arguments.store, recording));
  ENGRAM_RETURN_IF_ERROR(declare(recorder, types));
  return recorder;
}

/// Reports what is missing that should be there. Returns whether anything is.
bool tell_losses(const ImportArguments& arguments, const datasets::ReadingReport& reading,
                 const ltm::Recorder& recorder) {
  const std::string& source = arguments.from.empty() ? arguments.video : arguments.from;
  if (recorder.lost_frames() > 0)
    log::warning("store '{}': {} damaged places in the journal of an earlier session",
                 arguments.store, recorder.lost_frames());
  if (reading.damaged > 0)
    log::warning("'{}': {} damaged values are missing or partly guessed", source, reading.damaged);
  if (!reading.truncated_at.empty())
    log::warning("'{}' ends early: {}", source, reading.truncated_at);
  return recorder.lost_frames() > 0 || reading.damaged > 0 || !reading.truncated_at.empty();
}

/// Seals what was recorded, also before an error, and prints the report.
ExitCode finish(const ImportArguments& arguments, ltm::Recorder& recorder,
                ltm::SealedIndexer& indexer,
                const Result<datasets::RecordingImportReport>& report) {
  const Status closed = recorder.close();
  indexer.finish(interrupt_token());
  if (const uint64_t left = indexer.counters().left; left > 0)
    log::warning("{} segments have no indexes yet: the next night makes them", left);
  if (!report.ok()) fail(report.status());
  if (!closed.ok()) fail(closed);
  if (!report.ok() || !closed.ok()) return ExitCode::kFailed;
  if (arguments.is_json)
    print_json(reports::import_json(*report, recorder));
  else
    reports::print_import(*report, recorder);
  if (report->is_cancelled) return fail(cancelled("import was stopped; what was committed stays"));
  return tell_losses(arguments, report->reading, recorder) ? ExitCode::kDoneWithLoss
                                                           : ExitCode::kDone;
}

[[nodiscard]] bool is_vault(const ImportArguments& arguments) {
  if (arguments.from.empty()) return false;
  if (arguments.format != "auto") return arguments.format == "vault";
  const auto id = datasets::vault::read_vault_id(arguments.from);
  // What is damaged is told by who reads it.
  return id.ok() || id.status().code() == StatusCode::kDataLoss;
}

/// The name of an option that was given and that a vault leaves no choice for; empty if there is
/// none.
std::string option_without_choice(const CLI::App& command) {
  static const std::set<std::string> kChoices{"store",     "--from", "--format", "--keys",
                                              "--dry-run", "--json", "--help"};
  for (const CLI::Option* option : command.get_options())
    if (option->count() > 0 && !kChoices.contains(option->get_name(false, false)))
      return option->get_name(false, false);
  return {};
}

ExitCode run_vault(const ImportArguments& arguments, const CLI::App& command) {
  if (arguments.keys.empty())
    return wrong_usage(
        invalid_argument("import: '{}' is a vault, which needs --keys", printable(arguments.from)));
  if (const std::string option = option_without_choice(command); !option.empty())
    return wrong_usage(invalid_argument("import: a vault comes back as it was, found {}", option));
  if (arguments.store.empty() && !arguments.is_dry)
    return wrong_usage(invalid_argument("import: needs a STORE"));
  const datasets::vault::VaultPlaces places{arguments.from, arguments.keys};
  if (arguments.is_dry) {
    const auto keys = datasets::vault::read_keys_of(places);
    if (!keys.ok()) return fail(keys.status());
    if (arguments.is_json)
      print_json(reports::vault_list_json(*keys));
    else
      reports::print_vault_list(*keys);
    return ExitCode::kDone;
  }
  ProgressLine progress;
  const auto report = datasets::vault::import_from_vault(places, arguments.store, progress.sink(),
                                                         interrupt_token());
  progress.finish();
  if (!report.ok()) return fail(report.status());
  if (arguments.is_json)
    print_json(reports::vault_import_json(*report));
  else
    reports::print_vault_import(*report);
  if (report->is_cancelled)
    return fail(cancelled("import was stopped; what came in stays, and the same command goes on"));
  return report->damaged.empty() ? ExitCode::kDone : ExitCode::kDoneWithLoss;
}

ExitCode run(const ImportArguments& arguments, const CLI::App& command) {
  if (is_vault(arguments)) return run_vault(arguments, command);
  if (!arguments.keys.empty())
    return wrong_usage(
        invalid_argument("import: '{}' is no vault, found --keys", printable(arguments.from)));
  auto recording = recorder_options(arguments);
  if (!recording.ok()) return wrong_usage(recording.status());
  if (const Status status = recording->validate(); !status.ok()) return wrong_usage(status);
  const auto types = read_types(arguments.types);
  if (!types.ok()) return wrong_usage(types.status());
  const auto open = recording_opener(arguments);
  if (!open.ok()) return wrong_usage(open.status());
  if (arguments.store.empty() && !arguments.is_dry)
    return wrong_usage(invalid_argument("import: needs a STORE"));
  const auto opened = (*open)();
  if (!opened.ok()) return fail(opened.status());
  if (arguments.is_dry) {
    reports::show_streams(opened->format, opened->reader->streams(), arguments.is_json);
    return ExitCode::kDone;
  }
  ltm::SealedIndexer indexer(arguments.store);
  recording->store.after_seal = [&indexer](const std::string& segment) { indexer.add(segment); };
  auto recorder = open_recorder(arguments, *recording, *types);
  if (!recorder.ok()) return fail(recorder.status());
  ProgressLine progress;
  const auto report = datasets::import_recording(*opened->reader, opened->format, *recorder,
                                                 progress.sink(), interrupt_token());
  progress.finish();
  return finish(arguments, *recorder, indexer, report);
}

}  // namespace

void add_import_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ImportArguments>();
  CLI::App* command = app.add_subcommand("import", "Record what other programs recorded");
  command->footer(kImportFooter);
  add_import_options(*command, *arguments);
  command->callback([arguments, command, &exit_code] {
    arguments->has_rate = command->count("--rate") > 0;
    exit_code = run(*arguments, *command);
  });
}

}  // namespace engram::cli
