// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "tests/ltm/scratch_directory.h"

namespace engram::testing {

/// Writes a file that, unless said otherwise, its owner alone can read.
inline std::filesystem::path write_secret(const std::filesystem::path& path, std::string_view text,
                                          unsigned permissions = 0600) {
  overwrite_file(path, std::as_bytes(std::span(text)));
  std::filesystem::permissions(path, static_cast<std::filesystem::perms>(permissions));
  return path;
}

}  // namespace engram::testing
