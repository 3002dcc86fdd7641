// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: finds the files of a directory that are prior knowledge, and their
// entities.

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
  /// The ID of the entity; for kType the ID of the segment.
  ltm::MemoryId id;
  Time changed{};
  uint64_t bytes = 0;
};

struct PriorFiles {
  std::vector<PriorFile> files;                   ///< Ordered by path.
  std::optional<std::filesystem::path> settings;  ///< The path of prior.yaml.
  std::vector<std::string> problems;
};

/// Whether a file lies in a directory once symbolic links are followed.
[[nodiscard]] bool is_inside(const std::filesystem::path& path,
                             const std::filesystem::path& directory);

/// Decodes the name of a file or folder: `%2F` is a `/`, `%25` a `%`, and so on.
/// Errors: kInvalidArgument where a `%` is followed by anything but two hexadecimal digits, or the
/// name is empty or no UTF-8.
Result<std::string> prior_name(std::string_view file_name);

/// Finds at most `max_files` files.
/// Errors: kNotFound where there is no such directory.
Result<PriorFiles> find_prior_files(const std::filesystem::path& directory, size_t max_files,
                                    uint64_t max_file_bytes);

}  // namespace engram::memory
