// SPDX-License-Identifier: Apache-2.0
#include "store/fresh_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <string>

namespace engram::experiments {

namespace {

/// Writes the result of the child: {"found": ...} or {"error": message}.
[[noreturn]] void run_child(int to_parent, const std::function<Result<nlohmann::json>()>& work) {
  const Result<nlohmann::json> found = work();
  const nlohmann::json said = found.ok() ? nlohmann::json{{"found", *found}}
                                         : nlohmann::json{{"error", found.status().to_string()}};
  const std::string text = said.dump();
  for (size_t at = 0; at < text.size();) {
    const ssize_t count = ::write(to_parent, text.data() + at, text.size() - at);
    if (count <= 0) ::_exit(1);
    at += static_cast<size_t>(count);
  }
  std::fflush(stdout);
  ::_exit(0);
}

std::string read_all(int fd) {
  std::string text;
  std::array<char, 4096> block{};
  for (ssize_t count; (count = ::read(fd, block.data(), block.size())) > 0;)
    text.append(block.data(), static_cast<size_t>(count));
  return text;
}

}  // namespace

Result<nlohmann::json> in_fresh_process(const std::function<Result<nlohmann::json>()>& work) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) return unavailable("pipe: cannot be made");
  std::fflush(stdout);
  const pid_t child = ::fork();
  if (child < 0) return unavailable("child process: cannot be started");
  if (child == 0) {
    ::close(ends[0]);
    run_child(ends[1], work);
  }
  ::close(ends[1]);
  const std::string text = read_all(ends[0]);
  ::close(ends[0]);
  int state = 0;
  ::waitpid(child, &state, 0);
  const nlohmann::json said = nlohmann::json::parse(text, nullptr, false);
  if (said.is_discarded()) return unavailable("child process: ended with wait status {}", state);
  if (said.contains("error")) return unavailable("{}", said["error"].get<std::string>());
  return said.at("found");
}

}  // namespace engram::experiments
