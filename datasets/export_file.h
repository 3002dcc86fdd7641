// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "datasets/export_sink.h"
#include "ltm/core/file.h"

namespace engram::datasets {

/// A file that grows, and appears under its name when it is complete.
///
/// Threading: one thread.
class ExportFile {
 public:
  /// Creates `path` with the suffix ".part", and the directories above it.
  static Result<ExportFile> create(const std::filesystem::path& path);

  ExportFile(ExportFile&& other) noexcept = default;
  /// Removes the file if it was not closed.
  ~ExportFile();

  Status write(std::string_view text);

  /// Forces the file to disk, renames it, replacing any existing file, and counts it.
  Status close(ExportReport& report);

 private:
  ExportFile(std::filesystem::path path, File file)
      : path_(std::move(path)), file_(std::move(file)) {}

  Status flush();

  std::filesystem::path path_;
  std::optional<File> file_;
  std::string waiting_;
  uint64_t bytes_ = 0;
};

/// Writes one small file of many. It is complete or missing, but is not forced to disk.
Status write_export_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                         ExportReport& report);

}  // namespace engram::datasets
