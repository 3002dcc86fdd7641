// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "ltm/core/status.h"
#include "ltm/memory/result.h"

namespace engram::datasets {

/// What was written, and what could not be.
struct ExportReport {
  uint64_t snapshots = 0;  ///< That were handed over.
  uint64_t instances = 0;
  uint64_t files = 0;
  uint64_t bytes = 0;
  /// What the format cannot carry, in words ("lists and texts"), and how often that was met.
  std::map<std::string, uint64_t, std::less<>> not_carried;

  friend bool operator==(const ExportReport&, const ExportReport&) = default;
};

/// Writes snapshots in one format below one directory. Every file appears under its name only once
/// it is whole.
///
/// Snapshots come entity by entity, in the order of time.
/// Errors: kUnavailable, kResourceExhausted naming the file, everywhere.
/// Threading: one thread.
class SnapshotSink {
 public:
  virtual ~SnapshotSink() = default;

  /// The snapshots that follow are of `entity`; each entity comes once.
  virtual Status begin(const ltm::MemoryId& entity) = 0;

  virtual Status add(const ltm::SnapshotResult& snapshot) = 0;

  /// Ends what is open; nothing may follow. Without it, files that grow snapshot by snapshot are
  /// removed.
  virtual Status finish() = 0;

  [[nodiscard]] const ExportReport& report() const { return report_; }

 protected:
  ExportReport report_;
};

/// Choices that only some formats know.
struct ExportOptions {
  /// mp4: images per second. 0: the times of the snapshots.
  double rate_hz = 0;
  /// mp4: colour at full resolution (4:4:4), which browsers do not play.
  bool keeps_chroma = false;
  /// mp4: constant quality of libx264, 0 (best) to 51.
  int crf = 18;

  [[nodiscard]] Status validate() const;
};

inline constexpr std::array<std::string_view, 5> kExportFormats{"jsonl", "csv", "png", "mp4",
                                                                "armarx"};

/// A sink that writes below `directory`, which exists. The files of each format are described in
/// docs/export.md.
/// Errors: kInvalidArgument where there is no such format or `options` do not validate.
Result<std::unique_ptr<SnapshotSink>> make_snapshot_sink(std::string_view format,
                                                         const std::filesystem::path& directory,
                                                         const ExportOptions& options);

}  // namespace engram::datasets
