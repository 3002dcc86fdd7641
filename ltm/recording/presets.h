// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "ltm/core/status.h"

namespace engram::ltm {

/// A recording configuration that comes with the program.
struct RecordingPreset {
  std::string_view name;
  std::string_view yaml;
};

/// All presets, from the largest to the smallest recordings: "recorder", "balanced", "small".
[[nodiscard]] std::span<const RecordingPreset> all_recording_presets();

/// Returns the YAML text of a preset.
/// Errors: kNotFound listing the known names.
Result<std::string_view> recording_preset(std::string_view name);

}  // namespace engram::ltm
