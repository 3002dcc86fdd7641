// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "ltm/recording/presets.h"
#include "ltm/recording/recorder.h"

namespace engram::ltm {

/// Reads a recording configuration: entity patterns with their filters and codecs, and the options
/// of the store. `name` is what errors call it.
///
/// With `preset: NAME` in it the rest comes on top of that preset: settings replace its, and rules
/// come before its rules.
/// Errors: kInvalidArgument naming file, line and key; unknown keys come with the closest known
/// one.
/// Source: docs/recording.md.
Result<Recorder::Options> parse_recording_config(std::string_view text, const std::string& name);

/// Errors: kNotFound and kUnavailable too.
Result<Recorder::Options> read_recording_config(const std::filesystem::path& path);

}  // namespace engram::ltm
