// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/idf/data.h"
#include "ltm/memory/commit.h"
#include "ltm/memory/memory_id.h"

namespace engram::datasets {

/// A part of a recording that becomes one entity: a topic, a camera, a data set.
///
/// Its description is kept in the store beside the data (stream_entity()), so that an export can
/// restore all names.
struct RecordingStream {
  ltm::MemoryId entity;
  std::string name;     ///< The name in the file: "/camera/image_raw", "obs/agentview_image".
  uint64_t values = 0;  ///< Values in the whole recording; 0 if not known before it is read.
  /// What the format says about the stream apart from its values: the type of its messages, a unit.
  idf::Dict attributes;

  /// The time of the first value, if it is known before the stream is read. Not kept in the store.
  std::optional<Time> first = std::nullopt;
  /// What values are called in counts: "frames"; "values" if empty. Not kept in the store.
  std::string counted_as = {};

  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kInvalidArgument naming the member, what was found and what was needed.
  static Result<RecordingStream> from_data(const idf::Data& data);

  friend bool operator==(const RecordingStream&, const RecordingStream&) = default;
};

/// The description of one recording as a whole. A file with several episodes has several
/// recordings, one after the other in time.
struct RecordingEpisode {
  std::string format;  ///< The name of the format: "mcap".
  std::string name;    ///< The name in the file: "demo_0"; empty if the file is one recording.
  Time start{};
  idf::Dict attributes;  ///< Attributes of the episode; the first one also has those of the file.

  [[nodiscard]] idf::Data to_data() const;
  static Result<RecordingEpisode> from_data(const idf::Data& data);

  friend bool operator==(const RecordingEpisode&, const RecordingEpisode&) = default;
};

/// Makes an update with one instance that was measured, sent and received at `time`, which is what
/// imports assume.
[[nodiscard]] ltm::EntityUpdate imported(const ltm::MemoryId& entity, Time time, idf::Data value);

/// The entity that stores the description of a stream:
/// "Recording/Streams/mcap/Vision.RGB.robot.cam". Each entity has a different one.
[[nodiscard]] ltm::MemoryId stream_entity(std::string_view format, const ltm::MemoryId& entity);

/// The entity that stores the episodes: "Recording/Episodes/mcap/episodes".
[[nodiscard]] ltm::MemoryId episode_entity(std::string_view format);

/// What happened while a recording was read.
struct ReadingReport {
  /// What the files contain but was not imported, in words ("messages of foo/Bar"), and how often.
  std::map<std::string, uint64_t, std::less<>> not_carried;
  /// Values that could not be read and are missing, plus images that were imported although parts
  /// of them had to be guessed.
  uint64_t damaged = 0;
  /// Images that repeat the previous one exactly; they were imported.
  uint64_t duplicate_images = 0;
  /// Rows of a table before the first image of their video or after the last; they were imported.
  uint64_t rows_outside = 0;
  /// Where the file ends too early: file, offset and what was expected; empty if it is complete.
  std::string truncated_at;

  friend bool operator==(const ReadingReport&, const ReadingReport&) = default;
};

/// Reads one file or folder of another project's format in the order of time.
///
/// Errors: kInvalidArgument and kDataLoss naming file, offset (or row) and what was expected. A
/// file that ends early is read as far as it goes, and the report says so. Memory: bounded,
/// whatever the size of the file. Threading: one thread.
class RecordingReader {
 public:
  virtual ~RecordingReader() = default;

  /// The streams of the file. The list is complete from the beginning, and may be read while
  /// another thread reads values.
  [[nodiscard]] virtual const std::vector<RecordingStream>& streams() const = 0;

  /// The total number of values, for progress; 0 if not known. May be called as streams().
  [[nodiscard]] virtual uint64_t total() const = 0;

  /// The time of the first moment, if a start was requested or the file has one.
  [[nodiscard]] virtual std::optional<Time> start() const { return std::nullopt; }

  /// A value that is costly to make, so it is made only if a recorder takes it.
  struct UnmadeValue {
    /// Replaces the placeholder in `into`, which is as large, by the value. Called at most once, in
    /// the order of the moments, from one thread, which need not be the thread that reads. The
    /// reader outlives it.
    std::function<Status(ltm::EntityUpdate& into)> make;
    size_t bytes = 0;  ///< Memory that the unmade value holds.
  };

  /// The values of one time, which become one commit. Times never decrease; those of one entity
  /// increase. An episode comes with its first moment.
  struct Moment {
    std::optional<RecordingEpisode> begins;
    ltm::Commit commit;
    /// Makes the value of the only update of the commit; empty if the value is made already.
    std::optional<UnmadeValue> unmade = std::nullopt;
  };

  /// Returns the next moment; nothing after the last one.
  virtual Result<std::optional<Moment>> next() = 0;

  [[nodiscard]] const ReadingReport& report() const { return report_; }

 protected:
  ReadingReport report_;
};

}  // namespace engram::datasets
