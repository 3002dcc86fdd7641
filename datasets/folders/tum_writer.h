// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the writer of TUM folders.

#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// The assignment of entities to the tables of a folder: each table gets the first entity whose
/// newest value fits. "rgb" needs {"image"} with 8 bits, "depth" {"depth"} with 16 bits,
/// "groundtruth" {"position", "orientation"}, "accelerometer" {"values"} of three and that name.
struct TumPlan {
  std::map<ltm::MemoryId, std::string> tables;  ///< Tables by their entity.
  std::map<std::string, uint64_t, std::less<>> not_held;
};

/// Errors: those of Recall.
Result<TumPlan> plan_tum(ltm::Recall& recall, const ltm::Query& query,
                         const WritingOptions& options);

/// Errors: those of RecordingFormat::write. Memory: one snapshot.
Result<ExportReport> write_tum(ltm::Recall& recall, const ltm::Query& query,
                               const std::filesystem::path& path, const WritingOptions& options,
                               const ProgressSink& progress, const std::stop_token& stop);

}  // namespace engram::datasets
