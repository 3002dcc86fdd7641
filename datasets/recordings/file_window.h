// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "ltm/core/file.h"

namespace engram::datasets {

/// Reads parts of a file one after the other, mostly forwards.
///
/// Threading: one thread.
class FileWindow {
 public:
  /// Errors: those of File.
  static Result<FileWindow> open(const std::filesystem::path& path);

  [[nodiscard]] uint64_t size() const { return size_; }
  [[nodiscard]] const std::filesystem::path& path() const { return file_.path(); }

  /// The result is valid until the next call. The range must lie inside the file (checked).
  Result<std::span<const std::byte>> read(uint64_t offset, uint64_t count);

 private:
  FileWindow(File file, uint64_t size) : file_(std::move(file)), size_(size) {}

  File file_;
  uint64_t size_;
  uint64_t begin_ = 0;  ///< Offset of `bytes_` in the file.
  std::vector<std::byte> bytes_;
};

}  // namespace engram::datasets
