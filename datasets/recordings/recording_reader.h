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

/// What one entity gets of a recording: a topic, a camera, a data set.
///
/// Each is kept in the store beside the data (stream_entity()), so that an export can give
/// everything its own name back.
struct RecordingStream {
  ltm::MemoryId entity;
  std::string name;     ///< In the file: "/camera/image_raw", "obs/agentview_image".
  uint64_t values = 0;  ///< In the whole recording; 0: not known before it is read.
  /// What the format says of it beside its values: the type of its messages, a unit.
  idf::Dict attributes;

  /// When its first value is, where that is known before it is read. Not kept in the store.
  std::optional<Time> first = std::nullopt;
  /// What its values are called where they are counted: "frames"; empty: values. Likewise.
  std::string counted_as = {};

  [[nodiscard]] idf::Data to_data() const;

  /// Reads what to_data wrote; safe on hostile values.
  /// Errors: kInvalidArgument naming the member, what was found and what was needed.
  static Result<RecordingStream> from_data(const idf::Data& data);

  friend bool operator==(const RecordingStream&, const RecordingStream&) = default;
};

/// What one recording is as a whole. Files of several episodes have several recordings, one after
/// the other in time.
struct RecordingEpisode {
  std::string format;  ///< As formats are called: "mcap".
  std::string name;    ///< In the file: "demo_0"; empty where the file is one recording.
  Time start{};
  idf::Dict attributes;  ///< Of the episode and, in the first one, of the file.

  [[nodiscard]] idf::Data to_data() const;
  static Result<RecordingEpisode> from_data(const idf::Data& data);

  friend bool operator==(const RecordingEpisode&, const RecordingEpisode&) = default;
};

/// A value of one instance that was measured, sent and arrived at `time`, as imports say it.
[[nodiscard]] ltm::EntityUpdate imported(const ltm::MemoryId& entity, Time time, idf::Data value);

/// The entity that keeps the description of a stream:
/// "Recording/Streams/mcap/Vision.RGB.robot.cam"; another one for each entity.
[[nodiscard]] ltm::MemoryId stream_entity(std::string_view format, const ltm::MemoryId& entity);

/// The entity that keeps the episodes: "Recording/Episodes/mcap/episodes".
[[nodiscard]] ltm::MemoryId episode_entity(std::string_view format);

/// What was met while a recording was read.
struct ReadingReport {
  /// What is in the files and did not come in, in words ("messages of foo/Bar"), and how often.
  std::map<std::string, uint64_t, std::less<>> not_carried;
  /// Values that could not be read, and are missing; images that came in with guessed parts.
  uint64_t damaged = 0;
  /// Images that repeat the one before exactly; they came in.
  uint64_t duplicate_images = 0;
  /// Rows of a table before the first image of their video or after the last; they came in.
  uint64_t rows_outside = 0;
  /// Where the file ends before it should: file, offset and what was expected; empty: it does not.
  std::string truncated_at;

  friend bool operator==(const ReadingReport&, const ReadingReport&) = default;
};

/// Reads one file, or folder, of a format of other people, in the order of time.
///
/// Errors: kInvalidArgument and kDataLoss naming file, offset (or row) and what was expected. A
/// file that ends early is read as far as it goes, which the report says. Memory: bounded whatever
/// the file's size. Threading: one thread.
class RecordingReader {
 public:
  virtual ~RecordingReader() = default;

  /// Those of the file, from the beginning on: they may be asked for while another thread reads.
  [[nodiscard]] virtual const std::vector<RecordingStream>& streams() const = 0;

  /// How many values there are in all, for progress; 0: not known. Likewise.
  [[nodiscard]] virtual uint64_t total() const = 0;

  /// What the first moment's time was taken from, where a start was asked for or the file has one.
  [[nodiscard]] virtual std::optional<Time> start() const { return std::nullopt; }

  /// A value that costs much to make, so that it is made only where a recorder takes it.
  struct UnmadeValue {
    /// Puts the value in the place of one that is as large. Called once at most, in the order of
    /// the moments, from one thread that need not be the one that reads; the reader outlives it.
    std::function<Status(ltm::EntityUpdate& into)> make;
    size_t bytes = 0;  ///< Memory that it holds until then.
  };

  /// What becomes one commit: what has one time. Times never decrease; of one entity they increase.
  /// An episode comes with the first moment in it.
  struct Moment {
    std::optional<RecordingEpisode> begins;
    ltm::Commit commit;
    /// Of the only update of the commit, where it is not made yet.
    std::optional<UnmadeValue> unmade = std::nullopt;
  };

  /// Nothing behind the last one.
  virtual Result<std::optional<Moment>> next() = 0;

  [[nodiscard]] const ReadingReport& report() const { return report_; }

 protected:
  ReadingReport report_;
};

}  // namespace engram::datasets
