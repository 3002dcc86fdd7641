// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "datasets/recordings/exported_streams.h"

namespace engram::datasets::mcap {

/// Implements RecordingFormat::write for MCAP.
Result<ExportReport> export_mcap(const ExportRequest& request, const std::filesystem::path& path);

}  // namespace engram::datasets::mcap
