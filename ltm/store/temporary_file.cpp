// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/temporary_file.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>

#include "ltm/core/file.h"
#include "ltm/core/log.h"

namespace engram::ltm {

Result<std::filesystem::path> temporary_file(const std::filesystem::path& store,
                                             std::string_view suffix) {
  static std::atomic<uint64_t> number = 0;
  ENGRAM_RETURN_IF_ERROR(make_directories(store / "tmp"));
  return store / "tmp" / fmt::format("{}-{}{}", ::getpid(), number++, suffix);
}

bool belongs_to_dead_process(const std::string& name) {
  int process = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), process);
  if (error != std::errc() || process <= 0) return true;
  return process != ::getpid() && ::kill(process, 0) != 0 && errno == ESRCH;
}

Result<TemporaryFile> TemporaryFile::create(const std::filesystem::path& store,
                                            std::string_view suffix) {
  ENGRAM_ASSIGN_OR_RETURN(std::filesystem::path path, temporary_file(store, suffix));
  return TemporaryFile(std::move(path));
}

TemporaryFile::~TemporaryFile() {
  if (path_.empty()) return;
  if (const Status removed = remove_file(path_); !removed.ok())
    log::warning("a file is left over, which the next writer removes: {}", removed.to_string());
}

}  // namespace engram::ltm
