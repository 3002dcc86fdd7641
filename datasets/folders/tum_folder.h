// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// Errors: kInvalidArgument if the folder has none of the tables; those of TablesReader.
Result<std::unique_ptr<RecordingReader>> open_tum_folder(const std::filesystem::path& folder,
                                                         const ReadingOptions& options);

}  // namespace engram::datasets
