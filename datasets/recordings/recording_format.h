// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/recordings/export_report.h"
#include "datasets/recordings/recording_reader.h"
#include "ltm/core/progress.h"
#include "ltm/memory/query.h"
#include "ltm/recall/recall.h"

namespace engram::datasets {

/// Options for readers of all formats; each format uses those that it needs.
struct ReadingOptions {
  /// When the first episode begins. If empty, the file says it, else it is 1970-01-01.
  std::optional<Time> start;
  /// The time between the end of an episode and the start of the next one, if files do not say it.
  Duration episode_gap = std::chrono::seconds(10);
  /// Names of the episodes to read; all if empty.
  std::vector<std::string> episodes;
  /// The third name of the entities that are made.
  std::string provider = "robot";
  /// Values per second, for formats that do not say it. If it is 0, the format must say it.
  double rate_hz = 0;
};

/// Options for writers of all formats; each format uses those that it needs.
struct WritingOptions {
  /// Which form of a value is read if there are several.
  ltm::Recall::Options recall;
  /// The JPEG quality of images, 1 to 100, for formats that can hold JPEG. 0 stores images without
  /// loss.
  int jpeg_quality = 0;
};

/// A recording format of another project: how its files are recognised, read and written.
///
/// Threading: immutable, const-parallel.
/// Source: docs/formats.md.
class RecordingFormat {
 public:
  virtual ~RecordingFormat() = default;

  /// "mcap".
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// One line of text for the user.
  [[nodiscard]] virtual std::string_view about() const = 0;

  /// Returns true if a file or folder looks like this format, by its name and first bytes. Never
  /// fails.
  [[nodiscard]] virtual bool recognises(const std::filesystem::path& path) const = 0;

  /// Errors: kNotFound if the path does not exist; those of RecordingReader.
  [[nodiscard]] virtual Result<std::unique_ptr<RecordingReader>> open(
      const std::filesystem::path& path, const ReadingOptions& options) const = 0;

  [[nodiscard]] virtual bool can_write() const { return false; }

  /// Returns what the format cannot hold of a query's entities, in words, and for how many of them.
  /// It looks only at the newest value of each entity. Callers report it before they write.
  /// Errors: those of Recall; kFailedPrecondition if the format cannot be written.
  [[nodiscard]] virtual Result<std::map<std::string, uint64_t, std::less<>>> not_held(
      ltm::Recall& recall, const ltm::Query& query, const WritingOptions& options) const;

  /// Writes what a query selects to `path`, which must not exist; it appears when it is complete.
  /// Errors: kAlreadyExists; kNotFound if no entity matches; kCancelled after a stop; kUnavailable
  /// naming the file; those of Recall; kFailedPrecondition if the format cannot be written.
  [[nodiscard]] virtual Result<ExportReport> write(ltm::Recall& recall, const ltm::Query& query,
                                                   const std::filesystem::path& path,
                                                   const WritingOptions& options,
                                                   const ProgressSink& progress,
                                                   const std::stop_token& stop) const;
};

}  // namespace engram::datasets
