// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <memory>

#include "datasets/lerobot/lerobot_data.h"
#include "datasets/recordings/recording_format.h"

namespace engram::datasets::lerobot {

/// Reads the episodes whose files are there, one after the other.
/// Errors: kNotFound where there is none, or no episode of a name that is asked for.
Result<std::unique_ptr<RecordingReader>> make_reader(Description description,
                                                     const ReadingOptions& options);

}  // namespace engram::datasets::lerobot
