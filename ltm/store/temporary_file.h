// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "ltm/core/status.h"

namespace engram::ltm {

/// A file name of its own in the store's `tmp/`, for what is written before it is published.
/// What a killed process left there is removed by the next writer.
Result<std::filesystem::path> temporary_file(const std::filesystem::path& store,
                                             std::string_view suffix);

/// True where the process is gone that a file in `tmp/` with this name belongs to.
[[nodiscard]] bool belongs_to_dead_process(const std::string& name);

/// The place of a file in the store's `tmp/`. What lies there and was not published goes with this.
///
/// Owns: the file, where there is one. Threading: one thread.
class TemporaryFile {
 public:
  /// Errors: those of temporary_file.
  static Result<TemporaryFile> create(const std::filesystem::path& store, std::string_view suffix);
  ~TemporaryFile();
  TemporaryFile(TemporaryFile&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  TemporaryFile& operator=(TemporaryFile&&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  explicit TemporaryFile(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;  ///< Empty: moved away.
};

}  // namespace engram::ltm
