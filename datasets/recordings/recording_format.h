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

/// Choices for all formats; each uses those that it needs.
struct ReadingOptions {
  /// When the first episode begins; nothing: as the file says, else 1970-01-01.
  std::optional<Time> start;
  /// Between the end of an episode and the start of the next one, where files do not say when.
  Duration episode_gap = std::chrono::seconds(10);
  /// Names of episodes to read; empty: all.
  std::vector<std::string> episodes;
  /// Third name of the entities that are made.
  std::string provider = "robot";
  /// Values a second, where the format does not say; 0: it must.
  double rate_hz = 0;
};

/// Choices for all formats; each uses those that it needs.
struct WritingOptions {
  /// Which form is taken where both are there.
  ltm::Recall::Options recall;
  /// Images are compressed as JPEG of this quality, 1 to 100, where the format can; 0: without
  /// loss.
  int jpeg_quality = 0;
};

/// One format of other people: how its files are known, read and written.
///
/// Threading: immutable, const-parallel.
/// Source: docs/formats.md.
class RecordingFormat {
 public:
  virtual ~RecordingFormat() = default;

  /// "mcap".
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// One line for people.
  [[nodiscard]] virtual std::string_view about() const = 0;

  /// Whether a file or folder is one, by its name and how it begins. Never fails.
  [[nodiscard]] virtual bool recognises(const std::filesystem::path& path) const = 0;

  /// Errors: kNotFound where there is nothing; those of RecordingReader.
  [[nodiscard]] virtual Result<std::unique_ptr<RecordingReader>> open(
      const std::filesystem::path& path, const ReadingOptions& options) const = 0;

  [[nodiscard]] virtual bool can_write() const { return false; }

  /// What of a query's entities the format cannot hold, in words, and of how many entities; decides
  /// by the newest value of each. Told before anything is written. Errors: those of Recall;
  /// kFailedPrecondition where it cannot write.
  [[nodiscard]] virtual Result<std::map<std::string, uint64_t, std::less<>>> not_held(
      ltm::Recall& recall, const ltm::Query& query, const WritingOptions& options) const;

  /// Writes what a query asks for as `path`, which must not be there; it appears once it is whole.
  /// Errors: kAlreadyExists; kNotFound where no entity matches; kCancelled after a stop;
  /// kUnavailable naming the file; those of Recall; kFailedPrecondition where it cannot write.
  [[nodiscard]] virtual Result<ExportReport> write(ltm::Recall& recall, const ltm::Query& query,
                                                   const std::filesystem::path& path,
                                                   const WritingOptions& options,
                                                   const ProgressSink& progress,
                                                   const std::stop_token& stop) const;
};

}  // namespace engram::datasets
