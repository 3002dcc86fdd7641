// SPDX-License-Identifier: Apache-2.0
#include "cli/import_options.h"

#include <cstdio>
#include <map>

#include "datasets/formats.h"
#include "datasets/video_table.h"
#include "ltm/recording/recording_config.h"

namespace engram::cli {

namespace {

/// Parses "128x96" as width and height.
Status read_size(const std::string& text, datasets::VideoTable::Options& options) {
  if (text.empty()) return {};
  int used = 0;
  const int found = std::sscanf(text.c_str(), "%dx%d%n", &options.width, &options.height, &used);
  if (found == 2 && static_cast<size_t>(used) == text.size() && options.width > 0 &&
      options.height > 0)
    return {};
  return invalid_argument("--size '{}': needs WIDTHxHEIGHT, as in 128x128", text);
}

Result<datasets::VideoTable::Options> video_options(const ImportArguments& arguments) {
  static const std::map<std::string, datasets::TimeUnit> kUnits{
      {"s", datasets::TimeUnit::kSeconds},
      {"ms", datasets::TimeUnit::kMilliseconds},
      {"us", datasets::TimeUnit::kMicroseconds},
      {"ns", datasets::TimeUnit::kNanoseconds}};
  datasets::VideoTable::Options options;
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
  if (!arguments.start.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(options.start, parse_time(arguments.start));
  }
  ENGRAM_RETURN_IF_ERROR(options.validate());
  return options;
}

Result<datasets::ReadingOptions> reading_options(const ImportArguments& arguments) {
  datasets::ReadingOptions options = arguments.reading;
  ENGRAM_ASSIGN_OR_RETURN(options.episode_gap, parse_duration(arguments.episode_gap));
  if (!arguments.start.empty()) {
    ENGRAM_ASSIGN_OR_RETURN(options.start, parse_time(arguments.start));
  }
  return options;
}

Result<const datasets::RecordingFormat*> format_of(const ImportArguments& arguments) {
  if (arguments.format == "auto") return datasets::recognised_format(arguments.from);
  return datasets::find_recording_format(arguments.format);
}

/// Prints a preset and ends the program, before the other arguments are required.
void print_preset(const std::string& name) {
  const auto yaml = ltm::recording_preset(name);
  if (!yaml.ok()) throw CLI::ValidationError("--print-preset", yaml.status().message());
  fmt::print("{}", *yaml);
  throw CLI::Success();
}

/// Adds the options of what is recorded and how: a configuration, or simple options in its place.
void add_recording_options(CLI::App& command, ImportArguments& arguments) {
  CLI::Option* rate = command
                          .add_option("--rate", arguments.rate_hz,
                                      "Max number of snapshots per second that are kept")
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

/// Adds the options of reading whole recordings.
void add_reading_options(CLI::App& command, ImportArguments& arguments) {
  CLI::Option* from =
      command.add_option("--from", arguments.from, "A recording: file or folder, see below");
  const auto add = [&](const char* name, auto& value, const char* about) {
    return command.add_option(name, value, about)->needs(from)->capture_default_str();
  };
  add("--format", arguments.format, "Its format, or auto");
  command.add_option("--keys", arguments.keys, "The key file, if it is a vault")->needs(from);
  add("--provider", arguments.reading.provider, "Third name of the entities that are made");
  add("--episodes", arguments.reading.episodes, "Names of the episodes to take; else all")
      ->allow_extra_args(false)
      ->delimiter(',');
  add("--episode-gap", arguments.episode_gap,
      "Between episodes, where the file does not say when they were")
      ->check(duration_text());
  add("--value-rate", arguments.reading.rate_hz,
      "Values a second, where the file does not say; 0: it must");
  command.add_flag("--dry-run", arguments.is_dry, "Only list what is in the recording");
}

/// Adds the options of reading a video and its table.
void add_video_options(CLI::App& command, ImportArguments& arguments) {
  CLI::Option* video =
      command.add_option("--video", arguments.video, "Video, any codec that FFmpeg decodes")
          ->excludes("--from");
  CLI::Option* table = command.add_option("--table", arguments.table, "CSV of numbers over time");
  table->needs(video);
  command.add_option("--entity", arguments.entity, "Entity of the images")
      ->needs(video)
      ->check(entity_text());
  CLI::Option* state =
      command.add_option("--state-entity", arguments.state_entity, "Entity of the table's rows")
          ->check(entity_text());
  table->needs(state);
  state->needs(table);
  command.add_option("--start", arguments.start, "When the recording began")->check(time_text());
  command.add_option("--size", arguments.size, "Scale images to WIDTHxHEIGHT, area-averaged");
  command.add_flag("--crop-square", arguments.crops_square, "Cut out the centre square first");
  command.add_option("--time-column", arguments.time_column,
                     "Column of the table's times; else timestamp, time, t or stamp");
  command.add_option("--time-unit", arguments.time_unit, "Unit of that column")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}))
      ->capture_default_str();
  command.add_option("--skip-column", arguments.skip_columns,
                     "Leave a column of the table out; may be given again");
  add_type_options(command, arguments.types);
  command
      .add_option("--table-offset", arguments.table_offset,
                  "Added to the table's times to get the video's")
      ->check(duration_text())
      ->capture_default_str();
}

}  // namespace

void add_import_options(CLI::App& command, ImportArguments& arguments) {
  command.add_option("store", arguments.store, "Store; made where it does not exist");
  add_reading_options(command, arguments);
  add_video_options(command, arguments);
  add_recording_options(command, arguments);
  command.add_flag("--json", arguments.is_json, "Report as JSON");
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
    // Whole recordings lose no snapshot unless the user asks for it.
    const bool thins = arguments.from.empty() ? !arguments.keeps_all : arguments.has_rate;
    if (thins) options.max_rate_hz = arguments.rate_hz;
    options.pack.image_codec = arguments.image_codec;
  }
  options.store.durability = kLevels.at(arguments.durability);
  return options;
}

Result<std::function<Result<OpenedRecording>()>> recording_opener(
    const ImportArguments& arguments) {
  using Opener = std::function<Result<OpenedRecording>()>;
  if (arguments.from.empty()) {
    if (arguments.video.empty() || arguments.entity.empty())
      return invalid_argument("import: needs --from, or --video and --entity");
    ENGRAM_ASSIGN_OR_RETURN(auto options, video_options(arguments));
    return Opener([options = std::move(options)]() -> Result<OpenedRecording> {
      ENGRAM_ASSIGN_OR_RETURN(auto reader, datasets::VideoTable::open(options));
      return OpenedRecording{"video", std::move(reader)};
    });
  }
  ENGRAM_ASSIGN_OR_RETURN(auto options, reading_options(arguments));
  return Opener([&arguments, options = std::move(options)]() -> Result<OpenedRecording> {
    ENGRAM_ASSIGN_OR_RETURN(const auto* format, format_of(arguments));
    ENGRAM_ASSIGN_OR_RETURN(auto reader, format->open(arguments.from, options));
    return OpenedRecording{std::string(format->name()), std::move(reader)};
  });
}

}  // namespace engram::cli
