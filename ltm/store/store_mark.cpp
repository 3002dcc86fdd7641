// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/store_mark.h"

#include <sys/stat.h>

namespace engram::ltm {

StoreMark look_at_store(const std::filesystem::path& store) {
  StoreMark mark;
  struct stat found {};
  if (::stat((store / "MANIFEST.json").c_str(), &found) == 0)
    mark.manifest = {static_cast<int64_t>(found.st_ino),
                     int64_t{found.st_mtim.tv_sec} * 1'000'000'000 + found.st_mtim.tv_nsec,
                     int64_t{found.st_size}};
  std::error_code error;
  std::filesystem::directory_iterator journals(store / "journal", error);
  for (; !error && journals != std::filesystem::directory_iterator(); journals.increment(error)) {
    const uint64_t bytes = journals->file_size(error);
    if (!error) mark.journals[journals->path().filename().string()] = bytes;
    error.clear();
  }
  return mark;
}

}  // namespace engram::ltm
