// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the reader of folders of images with tables beside them.

#include "datasets/folders/table_lines.h"
#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// A member of a value that is made from one or more columns.
struct TableMember {
  std::string name;
  std::vector<size_t> columns;
  bool is_array = false;  ///< True for an ndarray [columns], false for a number.
};

/// The entity that gets one part of each line of a table.
struct TablePart {
  enum class Kind : uint8_t { kImage, kDepth, kNumbers };
  RecordingStream stream;
  Kind kind = Kind::kNumbers;
  std::vector<TableMember> members;  ///< Only for kNumbers.
};

/// A table, the times of its lines and the entities that it feeds.
struct TimedTable {
  TableLines lines;
  std::vector<TablePart> parts;
  std::optional<size_t> time_column;  ///< If empty, there are `rate_hz` lines per second.
  TimeUnit unit = TimeUnit::kNanoseconds;
  double rate_hz = 0;
  std::filesystem::path images;              ///< The folder of the images.
  std::optional<size_t> file_column;         ///< Has the names of images; if empty, see `files`.
  std::vector<std::filesystem::path> files;  ///< The names of images, one for each line.
};

/// Reads several tables in the order of time, and the images that they name.
///
/// Errors: kInvalidArgument naming table and line. Memory: a line and an image of each table, and
/// the names of images if a table does not name them.
class TablesReader final : public RecordingReader {
 public:
  /// `met`: what was found in the folder and is left out.
  /// Errors: kInvalidArgument if a first line is broken.
  static Result<std::unique_ptr<RecordingReader>> create(std::string_view format,
                                                         std::vector<TimedTable> tables,
                                                         ReadingReport met,
                                                         const ReadingOptions& options);

  [[nodiscard]] const std::vector<RecordingStream>& streams() const override { return streams_; }
  [[nodiscard]] uint64_t total() const override { return 0; }
  Result<std::optional<Moment>> next() override;

 private:
  struct Source {
    TimedTable table;
    std::optional<Time> time;  ///< The time of the next line; empty after the last one.
    uint64_t line = 0;         ///< Number of lines that were read.
  };

  TablesReader(std::string_view format, std::optional<Time> start)
      : format_(format), start_(start) {}

  Status advance(Source& source);
  Result<Time> time_of(const Source& source) const;
  Result<Time> shifted(Time time) const;
  Status add(Source& source, Time at, ltm::Commit& commit);
  Result<std::optional<idf::Data>> value_of(const Source& source, const TablePart& part) const;

  std::string format_;
  std::optional<Time> start_;  ///< The requested start.
  std::optional<Time> first_;  ///< The time of the first moment in the tables.
  std::vector<Source> sources_;
  std::vector<RecordingStream> streams_;
};

}  // namespace engram::datasets
