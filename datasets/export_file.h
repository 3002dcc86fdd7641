// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "datasets/export_sink.h"
#include "ltm/core/file.h"

namespace engram::datasets {

/// A file that grows and appears under its name once it is whole.
///
/// Threading: one thread.
class ExportFile {
 public:
  /// Makes `path` with ".part" behind it, and the directories above it.
  static Result<ExportFile> create(const std::filesystem::path& path);

  ExportFile(ExportFile&& other) noexcept = default;
  /// Removes what was not closed.
  ~ExportFile();

  Status write(std::string_view text);

  /// Forces the file to disk, moves it to its name, replacing what is there, and counts it.
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

/// Writes one small file of many: whole or not at all, but not forced to disk.
Status write_export_file(const std::filesystem::path& path, std::span<const std::byte> bytes,
                         ExportReport& report);

}  // namespace engram::datasets
