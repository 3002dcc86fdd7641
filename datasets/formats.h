// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// Returns all formats of whole recordings, in the order in which they are tried on a file.
[[nodiscard]] const std::vector<std::unique_ptr<const RecordingFormat>>& all_recording_formats();

/// Errors: kInvalidArgument naming all formats.
Result<const RecordingFormat*> find_recording_format(std::string_view name);

/// Returns the format of a file or folder.
/// Errors: kNotFound if there is no such file; kInvalidArgument naming all formats if none
/// recognises it.
Result<const RecordingFormat*> recognised_format(const std::filesystem::path& path);

}  // namespace engram::datasets
