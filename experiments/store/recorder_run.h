// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "store/store_measure.h"
#include "store/stream.h"

namespace engram::experiments {

/// How a stream is recorded.
struct RecorderRun {
  std::string name;       ///< What the report calls it.
  std::string config;     ///< YAML, docs/recording.md.
  bool keeps_all = true;  ///< There is no filter: everything must be in the store.
  /// Times real time; zero: as fast as it goes.
  double pace = 0;
};

/// What came of it.
struct RecorderFigures {
  double seconds = 0;  ///< Until everything was sealed and the store closed.
  /// Length of the stream / seconds; of a paced run / seconds until the last commit returned.
  double times_real = 0;
  double cpu_seconds = 0;  ///< Of all threads, the stream's own work included.
  uint64_t raw_bytes = 0;  ///< Of the stream.
  uint64_t disk_bytes = 0;
  uint64_t snapshots = 0;     ///< Kept.
  uint64_t memory_bytes = 0;  ///< Most that was resident beyond what the stream takes.
  Latency commit;
  double late_s = 0;  ///< Longest that a tick of a paced run began after its time.
};

/// Records the stream into `store`, made anew, and reads all of it again to compare.
/// Errors: those of Recorder, of memory and of verify_store; kDataLoss where something is missing.
Result<RecorderFigures> record_stream(const RecorderRun& run, const Stream& stream,
                                      const std::filesystem::path& store);

}  // namespace engram::experiments
