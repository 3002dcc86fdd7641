// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "cli/type_options.h"
#include "datasets/formats.h"
#include "datasets/media/video_reader.h"
#include "datasets/video_table.h"
#include "ltm/core/log.h"
#include "ltm/recording/recording_config.h"
#include "reports/plain/import_report.h"
#include "reports/plain/text.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter = R"(Examples:
  engram import --from recording.mcap --dry-run
  engram import --from recording.mcap robot.engram
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

Of a video every frame becomes a snapshot {"image", "state"}, every row of the table a snapshot of its
columns ("a.b" becomes {"a": {"b": ...}}) with a link to its image; each links to the nearest of
the other that came in. With --type values are stored as a segment's type has them, and refused where
they break it. Without --start the recording begins when the video says it was made, else
at 1970-01-01. Entities are filtered to --rate each; --all keeps everything. With --config or
--preset filters and codecs are those of the configuration (docs/recording.md).)";

struct ImportArguments {
  std::string store;
  std::string from;
  std::string format = "auto";
  datasets::ReadingOptions reading;
  std::string episode_gap = "10s";
  bool is_dry = false;
  std::string video;
  std::string table;
  std::string entity;
  std::string state_entity;
  std::string start;
  std::string table_offset = "0s";
  std::string time_column;
  std::string time_unit = "s";
  std::vector<std::string> skip_columns;
  TypeArguments types;
  std::string size;
  std::string config;
  std::string preset;
  std::string image_codec = "rowpred";
  std::string durability = "interval";
  double rate_hz = 5;
  bool keeps_all = false;
  bool has_rate = false;
  bool crops_square = false;
  bool is_json = false;
};

/// "128x96" as width and height.
Status read_size(const std::string& text, datasets::VideoTableImport& options) {
  if (text.empty()) return {};
  int used = 0;
  const int found = std::sscanf(text.c_str(), "%dx%d%n", &options.width, &options.height, &used);
  if (found == 2 && static_cast<size_t>(used) == text.size() && options.width > 0 &&
      options.height > 0)
    return {};
  return invalid_argument("--size '{}': needs WIDTHxHEIGHT, as in 128x128", text);
}

/// The start that was given, else the one in the video, else the epoch.
Result<Time> start_of(const ImportArguments& arguments) {
  if (!arguments.start.empty()) return parse_time(arguments.start);
  ENGRAM_ASSIGN_OR_RETURN(const auto reader, datasets::VideoReader::open(arguments.video, {}));
  return reader.info().created.value_or(Time{});
}

Result<datasets::VideoTableImport> import_options(const ImportArguments& arguments) {
  static const std::map<std::string, datasets::TimeUnit> kUnits{
      {"s", datasets::TimeUnit::kSeconds},
      {"ms", datasets::TimeUnit::kMilliseconds},
      {"us", datasets::TimeUnit::kMicroseconds},
      {"ns", datasets::TimeUnit::kNanoseconds}};
  datasets::VideoTableImport options;
  options.video = arguments.video;
  options.table = arguments.table;
  ENGRAM_ASSIGN_OR_RETURN(options.entity, ltm::MemoryId::parse(arguments.entity));
  ENGRAM_ASSIGN_OR_RETURN(options.state_entity, ltm::MemoryId::parse(arguments.state_entity));
  ENGRAM_ASSIGN_OR_RETURN(options.table_offset, parse_duration(arguments.table_offset));
  options.table_options.time_column = arguments.time_column;
  options.table_options.skip_columns = arguments.skip_columns;
  options.table_options.time_unit = kUnits.at(arguments.time_unit);
  options.crops_square = arguments.crops_square;
  ENGRAM_RETURN_IF_ERROR(read_size(arguments.size, options));
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return options;
}

Result<ltm::Recorder::Options> recorder_options(const ImportArguments& arguments) {
  static const std::map<std::string, ltm::Durability> kLevels{
      {"every", ltm::Durability::kEvery},
      {"interval", ltm::Durability::kInterval},
      {"none", ltm::Durability::kNone}};
  if (!arguments.config.empty()) return ltm::read_recording_config(arguments.config);
  ltm::Recorder::Options options;
  if (!arguments.preset.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(const std::string_view yaml, ltm::recording_preset(arguments.preset));
    ENGRAM_ASSIGN_OR_RETURN(
        options, ltm::parse_recording_config(yaml, fmt::format("preset '{}'", arguments.preset)));
  } else {
    // Whole recordings lose nothing unless somebody asks for it.
    const bool thins = arguments.from.empty() ? !arguments.keeps_all : arguments.has_rate;
    if (thins) options.max_rate_hz = arguments.rate_hz;
    options.pack.image_codec = arguments.image_codec;
  }
  options.store.durability = kLevels.at(arguments.durability);
  return options;
}

Result<const datasets::RecordingFormat*> format_of(const ImportArguments& arguments) {
  if (arguments.format == "auto") return datasets::recognised_format(arguments.from);
  return datasets::find_recording_format(arguments.format);
}

Result<datasets::ReadingOptions> reading_options(const ImportArguments& arguments) {
  datasets::ReadingOptions options = arguments.reading;
  ENGRAM_ASSIGN_OR_RETURN(options.episode_gap, parse_duration(arguments.episode_gap));
  if (!arguments.start.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(options.start, parse_time(arguments.start));
  }
  return options;
}

/// What is in a recording, without a store.
void print_streams(const datasets::RecordingFormat& format, const datasets::RecordingReader& reader,
                   bool is_json) {
  if (is_json) {
    Json streams = Json::array();
    for (const datasets::RecordingStream& stream : reader.streams())
      streams.push_back({{"name", stream.name},
                         {"entity", stream.entity.to_string()},
                         {"values", stream.values}});
    print_json({{"format", format.name()}, {"streams", std::move(streams)}});
    return;
  }
  reports::TextTable table({"in the " + std::string(format.name()), "becomes", "values"});
  for (const datasets::RecordingStream& stream : reader.streams())
    table.add({stream.name, stream.entity.to_string(),
               stream.values > 0 ? reports::count_text(stream.values) : "-"});
  print(table.to_string());
}

Result<ltm::Recorder> open_recorder(const ImportArguments& arguments,
                                    const ltm::Recorder::Options& recording,
                                    const std::vector<DeclaredType>& types) {
  ENGRAM_ASSIGN_OR_RETURN(ltm::Recorder recorder, ltm::Recorder::open(arguments.store, recording));
  ENGRAM_RETURN_IF_ERROR(declare(recorder, types));
  return recorder;
}

/// Seals what came in, before an error too, and says what it was.
template <typename Report>
ExitCode finish(const ImportArguments& arguments, ltm::Recorder& recorder,
                const Result<Report>& report) {
  const Status closed = recorder.close();
  if (!report.ok()) fail(report.status());
  if (!closed.ok()) fail(closed);
  if (!report.ok() || !closed.ok()) return ExitCode::kFailed;
  if (arguments.is_json)
    print_json(reports::import_json(*report, recorder));
  else
    reports::print_import(*report, recorder);
  if (report->is_cancelled) return fail(cancelled("import was stopped; what was committed stays"));
  if (recorder.lost_frames() == 0) return ExitCode::kDone;
  log::warning("store '{}': {} damaged places in the journal of an earlier session",
               arguments.store, recorder.lost_frames());
  return ExitCode::kDoneWithLoss;
}

ExitCode run_recording(const ImportArguments& arguments, const ltm::Recorder::Options& recording,
                       const std::vector<DeclaredType>& types) {
  const auto options = reading_options(arguments);
  if (!options.ok()) return wrong_usage(options.status());
  const auto format = format_of(arguments);
  if (!format.ok()) return fail(format.status());
  auto reader = (*format)->open(arguments.from, *options);
  if (!reader.ok()) return fail(reader.status());
  if (arguments.is_dry) {
    print_streams(**format, **reader, arguments.is_json);
    return ExitCode::kDone;
  }
  if (arguments.store.empty()) return wrong_usage(invalid_argument("import: needs a STORE"));
  auto recorder = open_recorder(arguments, recording, types);
  if (!recorder.ok()) return fail(recorder.status());
  ProgressLine progress;
  const auto report = datasets::import_recording(**reader, (*format)->name(), *recorder,
                                                 progress.sink(), interrupt_token());
  progress.finish();
  const ExitCode code = finish(arguments, *recorder, report);
  if (!report.ok() || code != ExitCode::kDone) return code;
  const datasets::ReadingReport& reading = report->reading;
  if (reading.damaged > 0)
    log::warning("'{}': {} damaged values are missing", arguments.from, reading.damaged);
  if (!reading.truncated_at.empty())
    log::warning("'{}' ends early: {}", arguments.from, reading.truncated_at);
  const bool has_loss = reading.damaged > 0 || !reading.truncated_at.empty();
  return has_loss ? ExitCode::kDoneWithLoss : code;
}

ExitCode run_video(const ImportArguments& arguments, const ltm::Recorder::Options& recording,
                   const std::vector<DeclaredType>& types) {
  auto options = import_options(arguments);
  if (!options.ok()) return wrong_usage(options.status());
  const auto start = start_of(arguments);
  if (!start.ok()) return fail(start.status());
  options->start = *start;
  auto recorder = open_recorder(arguments, recording, types);
  if (!recorder.ok()) return fail(recorder.status());
  ProgressLine progress;
  const auto report =
      datasets::import_video_table(*options, *recorder, progress.sink(), interrupt_token());
  progress.finish();
  const ExitCode code = finish(arguments, *recorder, report);
  if (!report.ok() || report->damaged_frames == 0) return code;
  log::warning("video '{}': {} damaged frames", arguments.video, report->damaged_frames);
  return code == ExitCode::kDone ? ExitCode::kDoneWithLoss : code;
}

ExitCode run(const ImportArguments& arguments) {
  const auto recording = recorder_options(arguments);
  if (!recording.ok()) return wrong_usage(recording.status());
  if (const Status status = recording->validate(); !status.ok()) return wrong_usage(status);
  const auto types = read_types(arguments.types);
  if (!types.ok()) return wrong_usage(types.status());
  if (!arguments.from.empty()) return run_recording(arguments, *recording, *types);
  if (arguments.video.empty() || arguments.entity.empty())
    return wrong_usage(invalid_argument("import: needs --from, or --video and --entity"));
  if (arguments.store.empty()) return wrong_usage(invalid_argument("import: needs a STORE"));
  return run_video(arguments, *recording, *types);
}

/// Prints a preset and ends the program, before other arguments are asked for.
void print_preset(const std::string& name) {
  const auto yaml = ltm::recording_preset(name);
  if (!yaml.ok()) throw CLI::ValidationError("--print-preset", yaml.status().message());
  fmt::print("{}", *yaml);
  throw CLI::Success();
}

/// What is recorded and how: a configuration, or the options for a simple one.
void add_recording_options(CLI::App& command, ImportArguments& arguments) {
  CLI::Option* rate =
      command.add_option("--rate", arguments.rate_hz, "Most snapshots per second that are kept")
          ->capture_default_str();
  CLI::Option* all =
      command.add_flag("--all", arguments.keeps_all, "Keep every snapshot")->excludes(rate);
  CLI::Option* codec =
      command.add_option("--image-codec", arguments.image_codec, "rowpred, png, zstd, ...")
          ->capture_default_str();
  CLI::Option* durability =
      command
          .add_option("--durability", arguments.durability,
                      "What a power cut may cost: nothing (every), 200 ms (interval), or what the "
                      "system had not written (none)")
          ->check(CLI::IsMember({"every", "interval", "none"}))
          ->capture_default_str();
  CLI::Option* preset = command.add_option("--preset", arguments.preset,
                                           "Configuration: recorder, balanced or small");
  CLI::Option* config = command.add_option("--config", arguments.config,
                                           "YAML file of filters, codecs and store options");
  preset->excludes(rate, all, codec);
  config->excludes(rate, all, codec, durability, preset);
  command
      .add_option_function<std::string>("--print-preset", print_preset,
                                        "Print a preset's YAML, to start a file from")
      ->trigger_on_parse();
}

/// What whole recordings are read with.
void add_reading_options(CLI::App& command, ImportArguments& arguments) {
  CLI::Option* from =
      command.add_option("--from", arguments.from, "A recording: file or folder, see below");
  const auto add = [&](const char* name, auto& value, const char* about) {
    return command.add_option(name, value, about)->needs(from)->capture_default_str();
  };
  add("--format", arguments.format, "Its format, or auto");
  add("--provider", arguments.reading.provider, "Third name of the entities that are made");
  add("--episodes", arguments.reading.episodes, "Names of the episodes to take; else all")
      ->allow_extra_args(false)
      ->delimiter(',');
  add("--episode-gap", arguments.episode_gap,
      "Between episodes, where the file does not say when they were")
      ->check(duration_text());
  add("--value-rate", arguments.reading.rate_hz,
      "Values a second, where the file does not say; 0: it must");
  command.add_flag("--dry-run", arguments.is_dry, "Only list what is in the recording")
      ->needs(from);
}

}  // namespace

void add_import_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ImportArguments>();
  CLI::App* command = app.add_subcommand("import", "Record what other programs recorded");
  command->footer(kFooter);
  command->add_option("store", arguments->store, "Store; made where it does not exist");
  add_reading_options(*command, *arguments);
  CLI::Option* video =
      command->add_option("--video", arguments->video, "Video, any codec that FFmpeg decodes")
          ->excludes("--from");
  CLI::Option* table = command->add_option("--table", arguments->table, "CSV of numbers over time");
  table->needs(video);
  command->add_option("--entity", arguments->entity, "Entity of the images")
      ->needs(video)
      ->check(entity_text());
  CLI::Option* state =
      command->add_option("--state-entity", arguments->state_entity, "Entity of the table's rows")
          ->check(entity_text());
  table->needs(state);
  state->needs(table);
  command->add_option("--start", arguments->start, "When the recording began")->check(time_text());
  command->add_option("--size", arguments->size, "Scale images to WIDTHxHEIGHT, area-averaged");
  command->add_flag("--crop-square", arguments->crops_square, "Cut out the centre square first");
  command->add_option("--time-column", arguments->time_column,
                      "Column of the table's times; else timestamp, time, t or stamp");
  command->add_option("--time-unit", arguments->time_unit, "Unit of that column")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}))
      ->capture_default_str();
  command->add_option("--skip-column", arguments->skip_columns,
                      "Leave a column of the table out; may be given again");
  add_type_options(*command, arguments->types);
  command
      ->add_option("--table-offset", arguments->table_offset,
                   "Added to the table's times to get the video's")
      ->check(duration_text())
      ->capture_default_str();
  add_recording_options(*command, *arguments);
  command->add_flag("--json", arguments->is_json, "Report as JSON");
  command->callback([arguments, command, &exit_code] {
    arguments->has_rate = command->count("--rate") > 0;
    exit_code = run(*arguments);
  });
}

}  // namespace engram::cli
