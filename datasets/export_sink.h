// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "datasets/recordings/export_report.h"
#include "ltm/core/status.h"
#include "ltm/memory/result.h"

namespace engram::datasets {

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
