// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// Bags of ROS 1, version 2.0, in chunks compressed with bz2, lz4 or not at all; written with lz4.
/// Source: docs/formats.md, "rosbag".
[[nodiscard]] std::unique_ptr<const RecordingFormat> make_rosbag_format();

}  // namespace engram::datasets
