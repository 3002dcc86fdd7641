// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "datasets/recordings/exported_streams.h"

namespace engram::datasets::rosbag {

/// Implements RecordingFormat::write for bags.
Result<ExportReport> export_bag(const ExportRequest& request, const std::filesystem::path& path);

}  // namespace engram::datasets::rosbag
