// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the reader of TUM folders.

#include "datasets/folders/listed_lines.h"
#include "datasets/recordings/recording_format.h"

namespace engram::datasets {

/// Reads the tables of a TUM folder beside each other.
///
/// Memory: one moment.
class TumReader final : public RecordingReader {
 public:
  /// Errors: kInvalidArgument where the folder has none of the tables.
  static Result<std::unique_ptr<RecordingReader>> open(const std::filesystem::path& folder,
                                                       const ReadingOptions& options);

  [[nodiscard]] const std::vector<RecordingStream>& streams() const override { return streams_; }
  [[nodiscard]] uint64_t total() const override { return 0; }
  Result<std::optional<Moment>> next() override;

 private:
  enum class Content : uint8_t { kImage, kDepth, kPose, kNumbers };
  struct Table {
    ListedLines lines;
    Content content;
    std::optional<ListedLines::Line> line;  ///< The next one.
    std::optional<Time> last;               ///< Of the line before.
  };

  explicit TumReader(std::filesystem::path folder) : folder_(std::move(folder)) {}

  Status add_table(const std::string& name, Content content, size_t words, std::string_view segment,
                   const ReadingOptions& options);
  Status advance(Table& table);
  std::optional<idf::Data> value_of(const Table& table) const;

  std::filesystem::path folder_;
  std::vector<RecordingStream> streams_;
  std::vector<Table> tables_;  ///< As streams.
  std::optional<Time> start_;  ///< That is asked for.
  std::optional<Time> first_;  ///< Of the first moment, as the tables say.
};

}  // namespace engram::datasets
