// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include "datasets/mcap/mcap_plan.h"

namespace engram::datasets::mcap {

/// RecordingFormat::write for MCAP.
Result<ExportReport> export_mcap(ltm::Recall& recall, const ltm::Query& query,
                                 const std::filesystem::path& path, const WritingOptions& options,
                                 const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::datasets::mcap
