// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the reader of folders of images with tables beside them.

#include "datasets/folders/table_lines.h"
#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// What one column, or some of them, become in a value.
struct TableMember {
  std::string name;
  std::vector<size_t> columns;
  bool is_array = false;  ///< An ndarray [columns], else a number.
};

/// What a line of a table gives one entity.
struct TablePart {
  enum class Kind : uint8_t { kImage, kDepth, kNumbers };
  RecordingStream stream;
  Kind kind = Kind::kNumbers;
  std::vector<TableMember> members;  ///< Of numbers.
};

/// A table, when its lines are and what they give.
struct TimedTable {
  TableLines lines;
  std::vector<TablePart> parts;
  std::optional<size_t> time_column;  ///< Without: `rate_hz` lines a second.
  TimeUnit unit = TimeUnit::kNanoseconds;
  double rate_hz = 0;
  std::filesystem::path images;              ///< Folder of images.
  std::optional<size_t> file_column;         ///< That names them; without:
  std::vector<std::filesystem::path> files;  ///< Their names, one for each line.
};

/// Reads tables beside each other, in the order of time, and the images that they name.
///
/// Errors: kInvalidArgument naming table and line. Memory: a line and an image of each table, and
/// the names of images where a table does not name them.
class TablesReader final : public RecordingReader {
 public:
  /// `met`: what of the folder is left out.
  /// Errors: kInvalidArgument where a first line is broken.
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
    std::optional<Time> time;  ///< Of the next line; nothing behind the last.
    uint64_t line = 0;         ///< Lines that were read.
  };

  TablesReader(std::string_view format, std::optional<Time> start)
      : format_(format), start_(start) {}

  Status advance(Source& source);
  Result<Time> time_of(const Source& source) const;
  Result<Time> shifted(Time time) const;
  Status add(Source& source, Time at, ltm::Commit& commit);
  Result<std::optional<idf::Data>> value_of(const Source& source, const TablePart& part) const;

  std::string format_;
  std::optional<Time> start_;  ///< That is asked for.
  std::optional<Time> first_;  ///< Of the first moment, as the tables say.
  std::vector<Source> sources_;
  std::vector<RecordingStream> streams_;
};

}  // namespace engram::datasets
