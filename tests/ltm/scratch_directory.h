// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdlib.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <system_error>

#include "ltm/core/check.h"

namespace engram {

/// A directory of its own for one test, removed with everything in it when this goes.
class ScratchDirectory {
 public:
  ScratchDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "engram-test-XXXXXX").string();
    ENGRAM_CHECK(::mkdtemp(name.data()) != nullptr, "cannot make '{}'", name);
    path_ = name;
  }
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;
  ~ScratchDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::filesystem::path& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// Writes a file without forcing it to the disk: for the many that only one test reads.
inline void overwrite_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  // Anew: file systems force a file that is written over to the disk.
  std::filesystem::remove(path);
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  ENGRAM_CHECK(file.good(), "cannot write '{}'", path.string());
}

}  // namespace engram
