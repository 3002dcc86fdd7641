// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/progress_line.h"
#include "cli/text.h"
#include "datasets/video_reader.h"
#include "datasets/video_table.h"
#include "ltm/core/log.h"
#include "ltm/idf/type_xml.h"
#include "ltm/recording/recording_config.h"

namespace engram::cli {

namespace {

constexpr const char* kFooter = R"(Examples:
  engram import --video V.mp4 --table T.csv --entity Vision/RGB/head/cam \
      --state-entity RobotState/Proprioception/robot/joints robot.engram
  engram import --video V.mp4 --entity Vision/RGB/head/cam --size 128x128 --rate 5 \
      --start '2022-02-18 13:06:56' robot.engram
  engram import --video V.mp4 --entity Vision/RGB/head/cam --types camera.xml \
      --type Vision/RGB=robot::View robot.engram
  engram import --video V.mp4 --entity Vision/RGB/head/cam --preset small robot.engram
  engram import --print-preset balanced > mine.yaml
  engram import --video V.mp4 --entity Vision/RGB/head/cam --config mine.yaml robot.engram

Every frame becomes a snapshot {"image", "state"}, every row of the table a snapshot of its
columns ("a.b" becomes {"a": {"b": ...}}) with a link to its image; each links to the nearest of
the other that came in. With --type values are stored as a segment's type has them, and refused where
they break it. Without --start the recording begins when the video says it was made, else
at 1970-01-01. Entities are filtered to --rate each; --all keeps everything. With --config or
--preset filters and codecs are those of the configuration (docs/recording.md).)";

struct ImportArguments {
  std::string store;
  std::string video;
  std::string table;
  std::string entity;
  std::string state_entity;
  std::string start;
  std::string table_offset = "0s";
  std::string time_column;
  std::string time_unit = "s";
  std::vector<std::string> skip_columns;
  std::vector<std::string> type_files;
  std::vector<std::string> types;  ///< "SEGMENT=NAME".
  std::string size;
  std::string config;
  std::string preset;
  std::string image_codec = "png";
  std::string durability = "interval";
  double rate_hz = 5;
  bool keeps_all = false;
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
    if (!arguments.keeps_all) options.max_rate_hz = arguments.rate_hz;
    options.pack.image_codec = arguments.image_codec;
  }
  options.store.durability = kLevels.at(arguments.durability);
  return options;
}

struct DeclaredType {
  ltm::MemoryId segment;
  idf::Type type;
};

/// "Vision/RGB=robot::View": a segment, and a type of the files.
Result<DeclaredType> read_type(const std::string& text, const std::vector<idf::TypeFile>& files) {
  const size_t equals = text.rfind('=');
  if (equals == std::string::npos)
    return invalid_argument("--type '{}': needs SEGMENT=NAME, as in Vision/RGB=robot::View", text);
  ENGRAM_ASSIGN_OR_RETURN(ltm::MemoryId segment, ltm::MemoryId::parse(text.substr(0, equals)));
  std::string known;
  for (const idf::TypeFile& file : files) {
    if (const idf::Type* type = file.find(text.substr(equals + 1)))
      return DeclaredType{std::move(segment), *type};
    for (const idf::Type& type : file.types) known += fmt::format(" {}", type.name());
  }
  return invalid_argument("--type '{}': no such type in the --types files; they have:{}", text,
                          known.empty() ? " none" : known);
}

Result<std::vector<DeclaredType>> read_types(const ImportArguments& arguments) {
  std::vector<idf::TypeFile> files;
  for (const std::string& path : arguments.type_files) {
    ENGRAM_ASSIGN_OR_RETURN(idf::TypeFile file, idf::read_type_file(path));
    files.push_back(std::move(file));
  }
  std::vector<DeclaredType> types;
  for (const std::string& text : arguments.types) {
    ENGRAM_ASSIGN_OR_RETURN(DeclaredType type, read_type(text, files));
    types.push_back(std::move(type));
  }
  return types;
}

Status declare(ltm::Recorder& recorder, const std::vector<DeclaredType>& types) {
  for (const DeclaredType& each : types)
    ENGRAM_RETURN_IF_ERROR(recorder.declare(each.segment, each.type));
  return {};
}

Json filter_json(const ltm::FilterCounters& counters) {
  return {{"filter", counters.filter},
          {"offered", counters.offered},
          {"offered_bytes", counters.offered_bytes},
          {"kept", counters.kept},
          {"dropped_by", counters.dropped_by},
          {"dropped_bytes", counters.dropped_bytes},
          {"held", counters.held.snapshots},
          {"held_bytes", counters.held.bytes}};
}

Json entity_json(const ltm::MemoryId& id, const ltm::RecordingCounters& counters) {
  Json filters = Json::array();
  for (const ltm::FilterCounters& filter : counters.filters) filters.push_back(filter_json(filter));
  return {{"entity", id.to_string()},
          {"rule", counters.rule},
          {"offered", counters.offered},
          {"kept", counters.kept},
          {"dropped_by", counters.dropped_by},
          {"held", counters.held.snapshots},
          {"held_bytes", counters.held.bytes},
          {"late", counters.late},
          {"failed", counters.failed},
          {"filters", std::move(filters)},
          {"reinterpreted", counters.reinterpreted},
          {"offered_bytes", counters.offered_bytes},
          {"kept_bytes", counters.kept_bytes},
          {"stored_bytes", counters.stored_bytes}};
}

Json report_json(const datasets::ImportReport& report, const ltm::Recorder& recorder) {
  Json entities = Json::array();
  for (const auto& [id, counters] : recorder.counters())
    entities.push_back(entity_json(id, counters));
  return {{"frames", report.frames},
          {"rows", report.rows},
          {"damaged_frames", report.damaged_frames},
          {"duplicate_frames", report.duplicate_frames},
          {"rows_outside_video", report.rows_outside_video},
          {"cancelled", report.is_cancelled},
          {"damaged_journal_places", recorder.lost_frames()},
          {"entities", std::move(entities)}};
}

/// "frequency 120 (rate 120), similarity 12 (similar 12)"; "0" where nothing was dropped.
std::string dropped_text(const ltm::RecordingCounters& counters) {
  std::string text;
  for (const ltm::FilterCounters& filter : counters.filters) {
    if (filter.dropped() == 0) continue;
    std::string reasons;
    for (const auto& [reason, count] : filter.dropped_by)
      reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", reason, count_text(count));
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", filter.filter, reasons);
  }
  return text.empty() ? "0" : text;
}

void print_filters(const ltm::MemoryId& id, const ltm::RecordingCounters& counters) {
  if (!counters.rule.empty())
    print(fmt::format("{}: rule '{}', dropped by {}", id.to_string(), counters.rule,
                      dropped_text(counters)));
  if (counters.held.snapshots > 0)
    print(fmt::format("{}: {} snapshots ({}) were still held by filters", id.to_string(),
                      count_text(counters.held.snapshots),
                      bytes_text(static_cast<double>(counters.held.bytes))));
  if (counters.late > 0)
    print(fmt::format("{}: {} snapshots came late, past the filters", id.to_string(),
                      count_text(counters.late)));
  if (counters.failed > 0)
    print(fmt::format("{}: {} snapshots could not be stored", id.to_string(),
                      count_text(counters.failed)));
}

void print_report(const datasets::ImportReport& report, const ltm::Recorder& recorder) {
  TextTable table({"entity", "offered", "kept", "dropped", "raw", "kept raw", "journal"});
  for (const auto& [id, counters] : recorder.counters()) {
    uint64_t total = 0;
    for (const auto& [filter, count] : counters.dropped_by) total += count;
    std::string dropped = count_text(total);
    for (const auto& [filter, count] : counters.dropped_by) dropped += " " + filter;
    table.add({id.to_string(), count_text(counters.offered), count_text(counters.kept), dropped,
               bytes_text(static_cast<double>(counters.offered_bytes)),
               bytes_text(static_cast<double>(counters.kept_bytes)),
               bytes_text(static_cast<double>(counters.stored_bytes))});
  }
  print(table.to_string());
  for (const auto& [id, counters] : recorder.counters()) print_filters(id, counters);
  for (const auto& [id, counters] : recorder.counters())
    if (counters.reinterpreted > 0)
      print(fmt::format("{}: {} values were cast to their segment's type ({})", id.to_string(),
                        count_text(counters.reinterpreted), counters.last_reinterpretation));
  if (report.first && report.last)
    print(fmt::format("{} to {}", to_string(*report.first), to_string(*report.last)));
  if (report.duplicate_frames > 0)
    print(fmt::format("{} frames repeat the one before exactly",
                      count_text(report.duplicate_frames)));
  if (report.rows_outside_video > 0)
    print(fmt::format("{} rows lie outside of the video", count_text(report.rows_outside_video)));
}

ExitCode run(const ImportArguments& arguments) {
  auto options = import_options(arguments);
  if (!options.ok()) return wrong_usage(options.status());
  const auto recording = recorder_options(arguments);
  if (!recording.ok()) return wrong_usage(recording.status());
  if (const Status status = recording->validate(); !status.ok()) return wrong_usage(status);
  const auto types = read_types(arguments);
  if (!types.ok()) return wrong_usage(types.status());
  const auto start = start_of(arguments);
  if (!start.ok()) return fail(start.status());
  options->start = *start;
  auto recorder = ltm::Recorder::open(arguments.store, *recording);
  if (!recorder.ok()) return fail(recorder.status());
  if (const Status status = declare(*recorder, *types); !status.ok()) return fail(status);
  ProgressLine progress;
  const auto report =
      datasets::import_video_table(*options, *recorder, progress.sink(), interrupt_token());
  progress.finish();
  // What was committed before an error stays, and is sealed like the rest.
  const Status closed = recorder->close();
  if (!report.ok()) fail(report.status());
  if (!closed.ok()) fail(closed);
  if (!report.ok() || !closed.ok()) return ExitCode::kFailed;
  if (arguments.is_json)
    print_json(report_json(*report, *recorder));
  else
    print_report(*report, *recorder);
  if (report->is_cancelled) return fail(cancelled("import was stopped; what was committed stays"));
  if (recorder->lost_frames() > 0)
    log::warning("store '{}': {} damaged places in the journal of an earlier session",
                 arguments.store, recorder->lost_frames());
  if (report->damaged_frames > 0)
    log::warning("video '{}': {} damaged frames", arguments.video, report->damaged_frames);
  return recorder->lost_frames() + report->damaged_frames > 0 ? ExitCode::kDoneWithLoss
                                                              : ExitCode::kDone;
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
  CLI::Option* codec = command.add_option("--image-codec", arguments.image_codec, "png, zstd, ...")
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

}  // namespace

void add_import_command(CLI::App& app, ExitCode& exit_code) {
  const auto arguments = std::make_shared<ImportArguments>();
  CLI::App* command = app.add_subcommand("import", "Record a video and a table into a store");
  command->footer(kFooter);
  command->add_option("store", arguments->store, "Store; made where it does not exist")->required();
  command->add_option("--video", arguments->video, "Video, any codec that FFmpeg decodes")
      ->required();
  CLI::Option* table = command->add_option("--table", arguments->table, "CSV of numbers over time");
  command->add_option("--entity", arguments->entity, "Entity of the images")
      ->required()
      ->check(entity_text());
  CLI::Option* state =
      command->add_option("--state-entity", arguments->state_entity, "Entity of the table's rows")
          ->check(entity_text());
  table->needs(state);
  state->needs(table);
  command->add_option("--start", arguments->start, "When the video began")->check(time_text());
  command->add_option("--size", arguments->size, "Scale images to WIDTHxHEIGHT, area-averaged");
  command->add_flag("--crop-square", arguments->crops_square, "Cut out the centre square first");
  command->add_option("--time-column", arguments->time_column,
                      "Column of the table's times; else timestamp, time, t or stamp");
  command->add_option("--time-unit", arguments->time_unit, "Unit of that column")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}))
      ->capture_default_str();
  command->add_option("--skip-column", arguments->skip_columns,
                      "Leave a column of the table out; may be given again");
  command->add_option("--types", arguments->type_files,
                      "XML type description (docs/idf.md); may be given again");
  command->add_option("--type", arguments->types,
                      "SEGMENT=NAME: the type of a core or provider segment; may be given again");
  command
      ->add_option("--table-offset", arguments->table_offset,
                   "Added to the table's times to get the video's")
      ->check(duration_text())
      ->capture_default_str();
  add_recording_options(*command, *arguments);
  command->add_flag("--json", arguments->is_json, "Report as JSON");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace engram::cli
