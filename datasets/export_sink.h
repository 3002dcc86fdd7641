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

/// Writes snapshots in one format below one directory. A file appears under its name only when it
/// is complete.
///
/// Snapshots arrive entity by entity, in the order of time.
/// Errors: every function returns kUnavailable or kResourceExhausted, naming the file.
/// Threading: one thread.
class SnapshotSink {
 public:
  virtual ~SnapshotSink() = default;

  /// Starts `entity`, to which the next snapshots belong. Each entity is started once.
  virtual Status begin(const ltm::MemoryId& entity) = 0;

  virtual Status add(const ltm::SnapshotResult& snapshot) = 0;

  /// Completes all open files; no other call may follow. Without it, files that grow snapshot by
  /// snapshot are removed.
  virtual Status finish() = 0;

  [[nodiscard]] const ExportReport& report() const { return report_; }

 protected:
  ExportReport report_;
};

/// Options that only some formats use.
struct ExportOptions {
  /// mp4: images per second. 0 keeps the times of the snapshots.
  double rate_hz = 0;
  /// mp4: colour at full resolution (4:4:4), which browsers do not play.
  bool keeps_chroma = false;
  /// mp4: constant quality of libx264, 0 (best) to 51.
  int crf = 18;

  [[nodiscard]] Status validate() const;
};

inline constexpr std::array<std::string_view, 5> kExportFormats{"jsonl", "csv", "png", "mp4",
                                                                "armarx"};

/// Makes a sink that writes below `directory`, which must exist. docs/export.md describes the files
/// of each format.
/// Errors: kInvalidArgument if there is no such format or `options` do not validate.
Result<std::unique_ptr<SnapshotSink>> make_snapshot_sink(std::string_view format,
                                                         const std::filesystem::path& directory,
                                                         const ExportOptions& options);

}  // namespace engram::datasets
