// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>

#include "datasets/media/table.h"
#include "ltm/core/progress.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"
#include "ltm/recording/recorder.h"

namespace engram::datasets {

/// Which video becomes the snapshots of one entity, and which table those of another.
struct VideoTableImport {
  std::filesystem::path video;
  /// Numbers over time of the same recording; empty: the video alone.
  std::filesystem::path table;

  /// Gets a snapshot per frame: {"image": uint8 [H, W, 3], "state": link}.
  ltm::MemoryId entity;
  /// Gets a snapshot per row: Table::row_value and {"camera": link}. Needed with a table.
  ltm::MemoryId state_entity;

  /// When the video began.
  Time start{};
  /// Added to the times of the table to get those of the video.
  Duration table_offset{};
  Table::Options table_options;

  /// Size and cut of the images; see VideoReader::Options. Unit: pixels.
  int width = 0;
  int height = 0;
  bool crops_square = false;
  int threads = 3;

  /// Named in the metadata of every instance.
  std::string provider = "import";
  /// Says when an instance was sent and arrived.
  Clock clock = system_now;

  [[nodiscard]] Status validate() const;
};

/// What an import did.
struct ImportReport {
  uint64_t frames = 0;  ///< Committed, or dropped by the recorder for their time alone.
  uint64_t rows = 0;    ///< Committed.
  /// Could not be decoded, or only with guessed parts; the latter were committed.
  uint64_t damaged_frames = 0;
  /// Frames that repeat the one before exactly, before scaling; they were committed.
  uint64_t duplicate_frames = 0;
  /// Rows before the first frame or after the last; they were committed.
  uint64_t rows_outside_video = 0;
  std::optional<Time> first;  ///< Of what was committed.
  std::optional<Time> last;
  bool is_cancelled = false;  ///< Stopped on request: there was more.
};

/// Commits a video and the table of the same recording in the order of time, one commit per frame
/// and row; a frame comes before a row of the same time.
///
/// Every image links to the row nearest in time and every row to the nearest image, the earlier
/// of two as near. The image of a frame that the recorder drops for its time alone is never made.
/// A link names a snapshot that was offered to the recorder: its filters may have dropped it. The
/// metadata's `created` is the time of the snapshot. A stop request is obeyed between two commits;
/// what was committed stays.
/// Errors: those of VideoReader and Table; kInvalidArgument where the options do not validate, the
/// video has no frame or the table has a column "camera"; kFailedPrecondition, before anything is
/// committed, where an entity has a snapshot at or after its first new one, naming a start that
/// fits; those of Recorder::commit. An error on the way says how much had been committed.
/// Memory: the table, and 32 MiB of decoded frames at most.
/// Threading: one thread; `progress` is called from it.
Result<ImportReport> import_video_table(const VideoTableImport& options, ltm::Recorder& recorder,
                                        const ProgressSink& progress, std::stop_token stop);

}  // namespace engram::datasets
