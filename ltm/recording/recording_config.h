// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "ltm/recording/presets.h"
#include "ltm/recording/recorder.h"

namespace engram::ltm {

/// Reads a recording configuration: entity patterns with their filters and codecs, and the options
/// of the store. `name` is its name in errors.
///
/// If the text has `preset: NAME`, its settings replace those of the preset, and its rules come
/// before the rules of the preset.
/// Errors: kInvalidArgument naming file, line and key; for an unknown key also the closest known
/// one.
/// Source: docs/recording.md.
Result<Recorder::Options> parse_recording_config(std::string_view text, const std::string& name);

/// Reads a recording configuration from a file.
/// Errors: as above; kNotFound; kUnavailable.
Result<Recorder::Options> read_recording_config(const std::filesystem::path& path);

}  // namespace engram::ltm
