// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "ltm/core/status.h"

namespace engram::ltm {

/// Returns a unique file name in the store's `tmp/` for a file that is written before it is
/// published. The next writer removes files that a killed process left there.
Result<std::filesystem::path> temporary_file(const std::filesystem::path& store,
                                             std::string_view suffix);

/// True if the process that the file `name` in `tmp/` belongs to no longer exists.
[[nodiscard]] bool belongs_to_dead_process(const std::string& name);

/// A file in the store's `tmp/`. The destructor removes it unless it was published.
///
/// Owns: the file, if it exists. Threading: one thread.
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

  std::filesystem::path path_;  ///< Empty after a move.
};

}  // namespace engram::ltm
