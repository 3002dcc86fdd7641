// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// All formats of whole recordings, in the order in which they are asked whether a file is theirs.
[[nodiscard]] const std::vector<std::unique_ptr<const RecordingFormat>>& all_recording_formats();

/// Errors: kInvalidArgument naming all there are.
Result<const RecordingFormat*> find_recording_format(std::string_view name);

/// The format of a file or folder.
/// Errors: kNotFound where there is nothing; kInvalidArgument where no format knows it, naming all.
Result<const RecordingFormat*> recognised_format(const std::filesystem::path& path);

}  // namespace engram::datasets
