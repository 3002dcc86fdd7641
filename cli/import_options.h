// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/type_options.h"
#include "datasets/recordings/recording_format.h"
#include "ltm/recording/recorder.h"

namespace engram::cli {

/// The options of `engram import`, unparsed.
struct ImportArguments {
  std::string store;
  std::string keys;  ///< Key file of a vault.
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

/// Adds all of them. `arguments` must outlive the command.
void add_import_options(CLI::App& command, ImportArguments& arguments);

/// Returns what to record and how, from the options.
/// Errors: those of the configuration; all of them are errors of the arguments.
Result<ltm::Recorder::Options> recorder_options(const ImportArguments& arguments);

struct OpenedRecording {
  std::string format;  ///< Such as "mcap"; "video" for a video with its table.
  std::unique_ptr<datasets::RecordingReader> reader;
};

/// Returns a function that opens the named recording. Errors of this call are errors of the
/// arguments; errors of the function are errors of the recording.
Result<std::function<Result<OpenedRecording>()>> recording_opener(const ImportArguments& arguments);

}  // namespace engram::cli
