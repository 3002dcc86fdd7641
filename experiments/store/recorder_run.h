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
  std::string name;       ///< Its name in the report.
  std::string config;     ///< YAML; see docs/recording.md.
  bool keeps_all = true;  ///< True if there is no filter, so that everything must be in the store.
  /// Speed as a multiple of real time; zero is as fast as possible.
  double pace = 0;
  /// Images are coded as they are sealed, as a live memory does once a night has learned from some.
  bool codes_images = false;
};

/// The measurements of one recording.
struct RecorderFigures {
  double seconds = 0;  ///< Until everything was sealed and the store closed.
  /// Length of the stream / seconds; for a paced run / seconds until the last commit returned.
  double times_real = 0;
  double cpu_seconds = 0;  ///< Of all threads, including the work to make the stream.
  uint64_t raw_bytes = 0;  ///< Size of the stream.
  uint64_t disk_bytes = 0;
  uint64_t snapshots = 0;     ///< Snapshots that were kept.
  uint64_t memory_bytes = 0;  ///< Peak resident memory beyond that of the stream.
  Latency commit;
  double late_s = 0;  ///< Maximum delay with which a tick of a paced run began.
};

/// Records the stream into `store`, which is made new, and reads all of it to compare.
/// Errors: those of Recorder, of memory and of verify_store; kDataLoss if something is missing.
Result<RecorderFigures> record_stream(const RecorderRun& run, const Stream& stream,
                                      const std::filesystem::path& store);

}  // namespace engram::experiments
