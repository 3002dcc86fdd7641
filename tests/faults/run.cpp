// SPDX-License-Identifier: Apache-2.0
#include "tests/faults/run.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

#include "ltm/core/check.h"
#include "ltm/core/file.h"
#include "ltm/core/log.h"

namespace engram::ltm::faults {

Outcome run_child(const std::function<void()>& work) {
  const pid_t child = ::fork();
  ENGRAM_CHECK(child >= 0, "no process");
  if (child == 0) {
    log::set_level(log::Level::kOff);
    work();
    ::_exit(0);
  }
  int status = 0;
  ENGRAM_CHECK(::waitpid(child, &status, 0) == child, "the child is gone");
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, WIFSIGNALED(status) ? WTERMSIG(status) : 0};
}

Tell tell_into(const std::filesystem::path& file) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  ENGRAM_CHECK(fd >= 0, "cannot open '{}'", file.string());
  return [fd](const Told& told) {
    ENGRAM_CHECK(::write(fd, &told, sizeof(told)) == sizeof(told), "cannot tell");
  };
}

std::vector<Told> told_of(std::string_view bytes) {
  std::vector<Told> told(bytes.size() / sizeof(Told));
  std::memcpy(told.data(), bytes.data(), told.size() * sizeof(Told));
  return told;
}

std::vector<Told> read_told(const std::filesystem::path& file) {
  const auto content = read_file(file);
  return content.ok() ? told_of(as_text(content->bytes())) : std::vector<Told>();
}

size_t stride_or_all(size_t stride) {
  return std::getenv("ENGRAM_FAULTS_ALL") == nullptr ? stride : 1;
}

}  // namespace engram::ltm::faults
