// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <memory>

#include "datasets/lerobot/lerobot_data.h"
#include "datasets/recordings/recording_format.h"

namespace engram::datasets::lerobot {

/// Reads the episodes whose files exist, one after the other.
/// Errors: kNotFound if there are none, or if there is no episode of a requested name.
Result<std::unique_ptr<RecordingReader>> make_reader(Description description,
                                                     const ReadingOptions& options);

}  // namespace engram::datasets::lerobot
