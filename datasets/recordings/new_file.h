// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "ltm/core/file.h"

namespace engram::datasets {

/// A file that appears under its name when it is complete. If it is never completed, nothing of it
/// remains.
///
/// Threading: one thread.
class NewFile {
 public:
  /// Creates `path` with the suffix ".part", and the directories above it.
  /// Errors: kAlreadyExists if `path` exists; kUnavailable.
  static Result<NewFile> create(const std::filesystem::path& path);

  NewFile(NewFile&&) noexcept = default;
  /// Removes the file if it was not published.
  ~NewFile();

  /// Errors, also of the functions below: kResourceExhausted if the disk is full, else
  /// kUnavailable.
  Status append(std::string_view bytes);

  /// Replaces bytes that were appended (checked).
  Status overwrite(uint64_t offset, std::string_view bytes);

  /// Unit: bytes.
  [[nodiscard]] uint64_t size() const { return size_; }

  /// Forces the file to disk and renames it. No other call may follow.
  Status publish();

 private:
  NewFile(std::filesystem::path path, File file) : path_(std::move(path)), file_(std::move(file)) {}

  std::filesystem::path path_;
  std::optional<File> file_;
  uint64_t size_ = 0;
};

}  // namespace engram::datasets
