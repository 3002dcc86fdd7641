// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// MCAP: messages of ROS 2, ROS 1 and others, in chunks compressed with zstd, lz4 or not at all.
/// Source: docs/formats.md, "MCAP".
[[nodiscard]] std::unique_ptr<const RecordingFormat> make_mcap_format();

}  // namespace engram::datasets
