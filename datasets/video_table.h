// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/media/table.h"
#include "datasets/media/video_reader.h"
#include "datasets/recordings/recording_reader.h"
#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::datasets {

/// Reads a video as the snapshots of one entity, and the table of the same recording as those of
/// another, in the order of time. A frame comes before a row of the same time.
///
/// Every image links to the row nearest in time, and every row to the nearest image; of two equally
/// near ones to the earlier. A link names a snapshot that was offered to the recorder, whose
/// filters may have dropped it. The metadata's `created` is the time of the snapshot. Images are
/// made only on demand: Moment::unmade. There are no episodes, so nothing is stored beside the
/// values. Memory: the table, and the decoder's frames. Threading: as RecordingReader; images are
/// made in another thread than the one that reads.
class VideoTable final : public RecordingReader {
 public:
  struct Options {
    std::filesystem::path video;
    /// Numbers over time of the same recording. If empty, only the video is read.
    std::filesystem::path table;

    /// The entity with a snapshot per frame: {"image": uint8 [H, W, 3], "state": link}.
    ltm::MemoryId entity;
    /// The entity with a snapshot per row: Table::row_value and {"camera": link}. Required with a
    /// table.
    ltm::MemoryId state_entity;

    /// When the video began. If empty, the video says it, else it is 1970-01-01.
    std::optional<Time> start;
    /// Added to the times of the table to convert them to times of the video.
    Duration table_offset{};
    Table::Options table_options;

    /// Size and cropping of the images; see VideoReader::Options. Unit: pixels.
    int width = 0;
    int height = 0;
    bool crops_square = false;
    int threads = 3;

    /// The provider in the metadata of every instance.
    std::string provider = "import";
    /// Gives the times at which an instance was sent and arrived. Called from the thread that
    /// reads.
    Clock clock = system_now;

    [[nodiscard]] Status validate() const;
  };

  /// Errors: those of VideoReader and Table; kInvalidArgument if the options do not validate, the
  /// video has no frame or the table has a column "camera".
  static Result<std::unique_ptr<RecordingReader>> open(const Options& options);

  [[nodiscard]] const std::vector<RecordingStream>& streams() const override { return streams_; }
  [[nodiscard]] uint64_t total() const override;
  [[nodiscard]] std::optional<Time> start() const override { return start_; }

  /// Errors: those of VideoReader::decode, after the frames before the error.
  Result<std::optional<Moment>> next() override;

 private:
  /// The rows of the table with their absolute times.
  struct Rows {
    Table table;
    std::vector<Time> times;
  };

  VideoTable(const Options& options, Time start, VideoReader video, std::optional<Rows> rows);

  static Result<Rows> read_rows(const Options& options, Time start);
  void add_stream(const ltm::MemoryId& entity, const std::filesystem::path& file,
                  std::string counted_as, uint64_t values, Time first);
  Status read_frame();
  Moment frame_moment();
  Moment row_moment();
  [[nodiscard]] ltm::EntityUpdate update(const ltm::MemoryId& entity, Time time,
                                         idf::Dict value) const;
  [[nodiscard]] bool has_row() const { return rows_ && row_ < rows_->times.size(); }
  [[nodiscard]] std::optional<Time> nearest_row(Time time) const;

  const Options options_;
  const Time start_;
  VideoReader video_;
  const idf::NdArray blank_;  ///< The placeholder for images, of the same size.
  const std::optional<Rows> rows_;
  std::vector<RecordingStream> streams_;
  std::optional<DecodedFrame> frame_;       ///< The next frame.
  std::optional<Time> frame_time_;          ///< The time of `frame_`.
  std::optional<DecodedFrame> last_frame_;  ///< The last frame that was returned.
  std::optional<Time> last_frame_time_;
  size_t row_ = 0;
  Status broken_;  ///< The error that ended the video; returned after the frame before it.
};

}  // namespace engram::datasets
