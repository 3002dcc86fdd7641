// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>

#include "datasets/recordings/recording_reader.h"
#include "ltm/core/progress.h"
#include "ltm/recording/recorder.h"

namespace engram::datasets {

/// What came in.
struct RecordingImportReport {
  uint64_t episodes = 0;
  uint64_t values =
      0;  ///< That the recorder took or dropped, without descriptions of streams and episodes.
  /// The same under the names that streams have for theirs: "frames", "rows".
  std::map<std::string, uint64_t, std::less<>> counts;
  std::optional<Time> first;
  std::optional<Time> last;
  ReadingReport reading;
  bool is_cancelled = false;  ///< Stopped on request: there was more.

  /// "12 values"; "12 frames and 5 rows" where streams have names for theirs.
  [[nodiscard]] std::string counted_text() const;
};

/// Commits everything that a reader has, and the descriptions of its streams and episodes. Values
/// that are not made yet and that the recorder drops for their time alone are never made. A stop
/// request is obeyed between two commits; what was committed stays.
/// Errors: those of the reader and of Recorder::commit; kFailedPrecondition, before anything is
/// committed, where an entity has a snapshot at or after its first new one, naming a start that
/// fits. An error on the way says how much had been committed.
/// Threading: one thread; `progress` is called from it.
Result<RecordingImportReport> import_recording(RecordingReader& reader, std::string_view format,
                                               ltm::Recorder& recorder,
                                               const ProgressSink& progress,
                                               const std::stop_token& stop);

}  // namespace engram::datasets
