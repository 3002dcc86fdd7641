// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/line_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

extern char** environ;

namespace engram {

namespace {

constexpr size_t kLastWords = 5;

void close_fd(int& fd) {
  if (fd >= 0) ::close(fd);
  fd = -1;
}

}  // namespace

LineProcess::~LineProcess() {
  close_fd(in_);
  close_fd(out_);
  if (pid_ < 0) return;
  ::kill(pid_, SIGTERM);
  ::waitpid(pid_, nullptr, 0);
}

Status LineProcess::start(const std::vector<std::string>& arguments) {
  program_ = arguments.at(0);
  std::array<int, 2> in{};
  std::array<int, 2> out{};
  // Closed on exec: a later child that inherited an end would keep this one's pipes open after its
  // death, and reading would wait for nothing.
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, in.data()) != 0)
    return unavailable("'{}': no socket: {}", program_, std::strerror(errno));
  if (::pipe2(out.data(), O_CLOEXEC) != 0) {
    ::close(in[0]);
    ::close(in[1]);
    return unavailable("'{}': no pipe: {}", program_, std::strerror(errno));
  }
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, in[1], STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  // Errors go to the same pipe, so that they are among the last lines that a failure reports.
  ::posix_spawn_file_actions_adddup2(&actions, out[1], STDERR_FILENO);
  std::vector<std::string> words = arguments;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int failed = ::posix_spawnp(&pid_, argv[0], &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(in[1]);
  ::close(out[1]);
  in_ = in[0];
  out_ = out[0];
  if (failed == 0) return {};
  pid_ = -1;
  if (failed == ENOENT) return not_found("program '{}' is not there", program_);
  return unavailable("'{}' cannot be started: {}", program_, std::strerror(failed));
}

Status LineProcess::write_line(const std::string& line) {
  const std::string text = line + "\n";
  for (size_t done = 0; done < text.size();) {
    const ssize_t sent = ::send(in_, text.data() + done, text.size() - done, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return unavailable("'{}' has ended{}", program_, last_words());
    done += static_cast<size_t>(sent);
  }
  return {};
}

Result<std::string> LineProcess::read_line(Duration patience) {
  const SteadyTime until = steady_now() + patience;
  while (true) {
    if (const size_t end = buffer_.find('\n'); end != std::string::npos) {
      std::string line = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      said_.push_back(line);
      if (said_.size() > kLastWords) said_.pop_front();
      return line;
    }
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - steady_now());
    pollfd waits{out_, POLLIN, 0};
    const int ready = left.count() > 0 ? ::poll(&waits, 1, static_cast<int>(left.count())) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0)
      return unavailable("'{}' said nothing for {}{}", program_, to_string(patience), last_words());
    std::array<char, 4096> bytes{};
    const ssize_t got = ::read(out_, bytes.data(), bytes.size());
    if (got <= 0) return unavailable("'{}' has ended{}", program_, last_words());
    buffer_.append(bytes.data(), static_cast<size_t>(got));
  }
}

std::string LineProcess::last_words() const {
  return said_.empty() ? "" : fmt::format("; its last words: {}", fmt::join(said_, " | "));
}

}  // namespace engram
