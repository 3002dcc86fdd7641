// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "ltm/core/file.h"

namespace engram::datasets {

/// A file that appears under its name once it is whole; without that nothing is left of it.
///
/// Threading: one thread.
class NewFile {
 public:
  /// Makes `path` with ".part" behind it, and the directories above it.
  /// Errors: kAlreadyExists where `path` is there; kUnavailable.
  static Result<NewFile> create(const std::filesystem::path& path);

  NewFile(NewFile&&) noexcept = default;
  /// Removes what was not published.
  ~NewFile();

  /// Errors: kResourceExhausted where the disk is full, else kUnavailable; here and below.
  Status append(std::string_view bytes);

  /// Writes over bytes that are there (checked).
  Status overwrite(uint64_t offset, std::string_view bytes);

  /// Unit: bytes.
  [[nodiscard]] uint64_t size() const { return size_; }

  /// Forces the file to disk and moves it to its name. Nothing may follow.
  Status publish();

 private:
  NewFile(std::filesystem::path path, File file) : path_(std::move(path)), file_(std::move(file)) {}

  std::filesystem::path path_;
  std::optional<File> file_;
  uint64_t size_ = 0;
};

}  // namespace engram::datasets
