// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>

#include "datasets/export_sink.h"
#include "ltm/memory/commit.h"

namespace engram::datasets {

/// Writes commits as plain files while they come, as the export format "armarx" lays them out
/// (docs/export.md): PNG for images, JSON for all else. Every file is whole or not there.
///
/// Threading: one thread.
class PlainFiles {
 public:
  /// `directory` exists.
  explicit PlainFiles(std::filesystem::path directory) : directory_(std::move(directory)) {}

  /// Errors: kUnavailable, kResourceExhausted naming the file.
  Status commit(const ltm::Commit& commit);

  /// Nothing may follow. Errors: as commit.
  Status finish();

 private:
  std::filesystem::path directory_;
  std::map<ltm::MemoryId, std::unique_ptr<SnapshotSink>> sinks_;
};

}  // namespace engram::datasets
