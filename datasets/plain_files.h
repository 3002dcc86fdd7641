// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>

#include "datasets/export_sink.h"
#include "ltm/memory/commit.h"

namespace engram::datasets {

/// Writes commits as plain files as they arrive, in the layout of the export format "armarx"
/// (docs/export.md): PNG for images, JSON for everything else. Every file is complete or missing.
///
/// Threading: one thread.
class PlainFiles {
 public:
  /// `directory` must exist.
  explicit PlainFiles(std::filesystem::path directory) : directory_(std::move(directory)) {}

  /// Errors: kUnavailable, kResourceExhausted naming the file.
  Status commit(const ltm::Commit& commit);

  /// Completes all files; no other call may follow. Errors: as commit.
  Status finish();

 private:
  std::filesystem::path directory_;
  std::map<ltm::MemoryId, std::unique_ptr<SnapshotSink>> sinks_;
};

}  // namespace engram::datasets
