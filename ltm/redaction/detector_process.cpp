// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/detector_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <thread>

extern char** environ;

namespace engram::ltm {

namespace {

/// How long a wait lasts before the stop token is looked at. Unit: ms.
constexpr int kLook_ms = 50;

void close_end(int& end) {
  if (end >= 0) ::close(end);
  end = -1;
}

/// The file of a program, as a shell finds it; empty: there is none.
std::string file_of(const std::string& program) {
  if (program.find('/') != std::string::npos)
    return ::access(program.c_str(), X_OK) == 0 ? program : "";
  const char* const path = std::getenv("PATH");
  std::string_view rest = path == nullptr ? "/usr/local/bin:/usr/bin:/bin" : path;
  while (!rest.empty()) {
    const size_t end = std::min(rest.find(':'), rest.size());
    const std::string file = (std::filesystem::path(rest.substr(0, end)) / program).string();
    if (::access(file.c_str(), X_OK) == 0) return file;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return "";
}

/// What the child does until it is another program. Only calls that are safe between fork and exec
/// in a process with threads.
[[noreturn]] void become(const char* file, char** argv, int in, int out, int failed, pid_t parent) {
  ::setpgid(0, 0);
  // Not even `kill -9` of this process leaves the program behind.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int number : {SIGINT, SIGTERM, SIGPIPE, SIGHUP, SIGCHLD}) ::signal(number, SIG_DFL);
  ::dup2(in, STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
#ifdef SYS_close_range
  constexpr unsigned kCloseOnExec = 4;
  ::syscall(SYS_close_range, 3U, ~0U, kCloseOnExec);
#endif
  ::execve(file, argv, environ);
  const int error = errno;
  [[maybe_unused]] const ssize_t told = ::write(failed, &error, sizeof(error));
  ::_exit(127);
}

int ms_until(SteadyTime until) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - steady_now());
  return static_cast<int>(std::clamp<int64_t>(left.count(), 0, kLook_ms));
}

}  // namespace

Status DetectorProcess::start(const std::vector<std::string>& command) {
  end();
  buffer_.clear();
  program_ = command.at(0);
  const std::string file = file_of(program_);
  if (file.empty()) return not_found("program '{}' is not there, or may not be run", program_);
  std::vector<std::string> words = command;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::array<int, 2> in{-1, -1}, out{-1, -1}, failed{-1, -1};
  const bool has_ends = ::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, in.data()) == 0 &&
                        ::pipe2(out.data(), O_CLOEXEC) == 0 &&
                        ::pipe2(failed.data(), O_CLOEXEC) == 0;
  const pid_t parent = ::getpid();
  const pid_t child = has_ends ? ::fork() : -1;
  if (child == 0) become(file.c_str(), argv.data(), in[1], out[1], failed[1], parent);
  const int error_of_fork = errno;
  for (int* const end : {&in[1], &out[1], &failed[1]}) close_end(*end);
  if (child < 0) {
    for (int* const end : {&in[0], &out[0], &failed[0]}) close_end(*end);
    return unavailable("'{}' cannot be started: {}", program_, std::strerror(error_of_fork));
  }
  pid_ = child;
  in_ = in[0];
  out_ = out[0];
  ::setpgid(pid_, pid_);
  ::fcntl(in_, F_SETFL, O_NONBLOCK);
  ::fcntl(out_, F_SETFL, O_NONBLOCK);
  int error_of_exec = 0;
  ssize_t told = 0;
  do {
    told = ::read(failed[0], &error_of_exec, sizeof(error_of_exec));
  } while (told < 0 && errno == EINTR);
  close_end(failed[0]);
  if (told != sizeof(error_of_exec)) return {};
  end();
  return unavailable("'{}' cannot be started: {}", program_, std::strerror(error_of_exec));
}

Status DetectorProcess::write(std::span<const std::byte> bytes, SteadyTime until) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(in_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<size_t>(sent));
      continue;
    }
    if (sent < 0 && errno == EINTR) continue;
    if (sent == 0 || (errno != EAGAIN && errno != EWOULDBLOCK))
      return unavailable("'{}' has ended", program_);
    if (steady_now() >= until) return unavailable("'{}' does not read in time", program_);
    pollfd waits{in_, POLLOUT, 0};
    ::poll(&waits, 1, ms_until(until));
  }
  return {};
}

Result<std::string> DetectorProcess::read_line(SteadyTime until, const std::stop_token& stop) {
  for (size_t looked = 0;;) {
    if (const size_t end = buffer_.find('\n', looked); end != std::string::npos) {
      std::string line = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      return line;
    }
    looked = buffer_.size();
    if (buffer_.size() > kMaxLine)
      return unavailable("'{}' wrote a line of more than {} bytes", program_, kMaxLine);
    if (stop.stop_requested()) return cancelled("'{}': stopped", program_);
    if (steady_now() >= until) return unavailable("'{}' gave no answer in time", program_);
    pollfd waits{out_, POLLIN, 0};
    if (::poll(&waits, 1, ms_until(until)) <= 0) continue;
    std::array<char, 65536> bytes;
    const ssize_t got = ::read(out_, bytes.data(), bytes.size());
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got <= 0) return unavailable("'{}' has ended", program_);
    buffer_.append(bytes.data(), static_cast<size_t>(got));
  }
}

void DetectorProcess::end(Duration grace) {
  close_end(in_);
  if (pid_ >= 0) {
    const SteadyTime until = steady_now() + grace;
    // Not waited for yet, so that its number, by which its group is killed, stays its own.
    const auto has_ended = [this] {
      siginfo_t info{};
      return ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
             info.si_pid == pid_;
    };
    while (steady_now() < until && !has_ended())
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    // Its children, too, which may have outlived it.
    ::kill(-pid_, SIGKILL);
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) continue;
    pid_ = -1;
  }
  close_end(out_);
}

}  // namespace engram::ltm
