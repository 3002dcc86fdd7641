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

/// The result of an import.
struct RecordingImportReport {
  uint64_t episodes = 0;
  /// Values that the recorder took or dropped, without descriptions of streams and episodes.
  uint64_t values = 0;
  /// The same values by the names that their streams use for them: "frames", "rows".
  std::map<std::string, uint64_t, std::less<>> counts;
  std::optional<Time> first;
  std::optional<Time> last;
  ReadingReport reading;
  bool is_cancelled = false;  ///< Stopped on request before the end of the recording.

  /// Returns "12 values", or "12 frames and 5 rows" if streams have names for their values.
  [[nodiscard]] std::string counted_text() const;
};

/// Commits all values of a reader, and the descriptions of its streams and episodes. A value that
/// is made lazily and that the recorder drops because of its time is never made. A stop request
/// takes effect between two commits; what was committed stays.
/// Errors: those of the reader and of Recorder::commit; kFailedPrecondition, before anything is
/// committed, if an entity has a snapshot at or after its first new one, naming a start that fits.
/// An error in the middle says how much was committed.
/// Threading: one thread; `progress` is called from it.
Result<RecordingImportReport> import_recording(RecordingReader& reader, std::string_view format,
                                               ltm::Recorder& recorder,
                                               const ProgressSink& progress,
                                               const std::stop_token& stop);

}  // namespace engram::datasets
