// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: which files of a directory are prior knowledge, and of what.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ltm/core/time.h"
#include "ltm/memory/memory_id.h"

namespace engram::memory {

enum class PriorFileKind : uint8_t { kJson, kYaml, kPicture, kBytes, kType };

struct PriorFile {
  std::filesystem::path path;
  PriorFileKind kind = PriorFileKind::kBytes;
  /// The entity; of kType the segment.
  ltm::MemoryId id;
  Time changed{};
  uint64_t bytes = 0;
};

struct PriorFiles {
  std::vector<PriorFile> files;                   ///< In the order of their paths.
  std::optional<std::filesystem::path> settings;  ///< prior.yaml
  std::vector<std::string> problems;
};

/// Whether a file, links followed, lies in a directory.
[[nodiscard]] bool is_inside(const std::filesystem::path& path,
                             const std::filesystem::path& directory);

/// The name that a file or folder stands for: `%2F` is a `/`, `%25` a `%`, and so on.
/// Errors: kInvalidArgument where a `%` is followed by anything but two hexadecimal digits, or the
/// name is empty or no UTF-8.
Result<std::string> prior_name(std::string_view file_name);

/// Finds at most so many files.
/// Errors: kNotFound where there is no such directory.
Result<PriorFiles> find_prior_files(const std::filesystem::path& directory, size_t max_files,
                                    uint64_t max_file_bytes);

}  // namespace engram::memory
