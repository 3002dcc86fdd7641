// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/line_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <thread>

#include "ltm/core/buffer.h"

namespace engram {

namespace {

constexpr size_t kLastWords = 5;
/// How long a wait lasts before the stop token is looked at. Unit: ms.
constexpr int kLook_ms = 50;
/// How often the end of a process is looked for.
constexpr Duration kEndLook = std::chrono::milliseconds(5);

void close_fd(int& fd) {
  if (fd >= 0) ::close(fd);
  fd = -1;
}

int ms_of_wait(SteadyTime until) {
  const SteadyTime now = steady_now();
  if (until <= now) return 0;
  if (until - now > std::chrono::milliseconds(kLook_ms)) return kLook_ms;
  return static_cast<int>(
      std::chrono::duration_cast<std::chrono::milliseconds>(until - now).count());
}

}  // namespace

Status LineProcess::start(const std::vector<std::string>& arguments, const Options& options) {
  end();
  options_ = options;
  program_ = arguments.at(0);
  buffer_.clear();
  said_.clear();
  std::array<int, 2> in{-1, -1};
  std::array<int, 2> out{-1, -1};
  // Closed on exec: a later child that inherited an end would keep this one's pipes open after its
  // death, and reading would wait for nothing.
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, in.data()) != 0)
    return unavailable("'{}': no socket: {}", program_, std::strerror(errno));
  if (::pipe2(out.data(), O_CLOEXEC) != 0) {
    const int error = errno;
    for (int& fd : in) close_fd(fd);
    return unavailable("'{}': no pipe: {}", program_, std::strerror(error));
  }
  const auto started = start_child(
      arguments, {out[1], options.has_errors ? std::optional(out[1]) : std::nullopt, in[1]},
      options.life);
  close_fd(in[1]);
  close_fd(out[1]);
  in_ = in[0];
  out_ = out[0];
  for (const int fd : {in_, out_}) ::fcntl(fd, F_SETFL, O_NONBLOCK);
  if (started.ok()) {
    pid_ = *started;
    return {};
  }
  end();
  if (started.status().code() == StatusCode::kNotFound)
    return not_found("program '{}' is not there", program_);
  return unavailable("'{}' cannot be started: {}", program_, started.status().message());
}

Status LineProcess::write(std::span<const std::byte> bytes, SteadyTime until) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(in_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes = bytes.subspan(static_cast<size_t>(sent));
      continue;
    }
    if (sent < 0 && errno == EINTR) continue;
    if (sent == 0 || (errno != EAGAIN && errno != EWOULDBLOCK))
      return unavailable("'{}' has ended{}", program_, last_words());
    if (steady_now() >= until)
      return unavailable("'{}' does not read in time{}", program_, last_words());
    pollfd waits{in_, POLLOUT, 0};
    ::poll(&waits, 1, ms_of_wait(until));
  }
  return {};
}

Status LineProcess::write_line(const std::string& line, SteadyTime until) {
  return write(as_bytes(line + "\n"), until);
}

Result<std::string> LineProcess::read_line(SteadyTime until, const std::stop_token& stop) {
  for (size_t looked = 0;;) {
    if (const size_t end = buffer_.find('\n', looked); end != std::string::npos) {
      std::string line = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      if (options_.has_errors) said_.push_back(line);
      if (said_.size() > kLastWords) said_.pop_front();
      return line;
    }
    looked = buffer_.size();
    if (looked > options_.max_line)
      return unavailable("'{}' wrote a line of more than {} bytes", program_, options_.max_line);
    ENGRAM_RETURN_IF_ERROR(take_more(until, stop));
  }
}

/// Appends what it wrote to the buffer, if it wrote anything.
Status LineProcess::take_more(SteadyTime until, const std::stop_token& stop) {
  if (stop.stop_requested()) return cancelled("'{}': stopped", program_);
  if (steady_now() >= until)
    return unavailable("'{}' gave no answer in time{}", program_, last_words());
  pollfd waits{out_, POLLIN, 0};
  if (::poll(&waits, 1, ms_of_wait(until)) <= 0) return {};
  std::array<char, 65536> bytes;
  const ssize_t got = ::read(out_, bytes.data(), bytes.size());
  if (got < 0 && (errno == EINTR || errno == EAGAIN)) return {};
  if (got <= 0) return unavailable("'{}' has ended{}", program_, last_words());
  buffer_.append(bytes.data(), static_cast<size_t>(got));
  return {};
}

/// It is not waited for yet, so that its number, by which its group is killed, stays its own.
bool LineProcess::has_ended() const {
  siginfo_t info{};
  return ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         info.si_pid == pid_;
}

void LineProcess::end(Duration grace) {
  close_fd(in_);
  if (pid_ >= 0) {
    const SteadyTime until = steady_now() + grace;
    while (steady_now() < until && !has_ended()) std::this_thread::sleep_for(kEndLook);
    // Its children, too, which may have outlived it.
    ::kill(-pid_, SIGKILL);
    ::kill(pid_, SIGKILL);
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) continue;
    pid_ = -1;
  }
  close_fd(out_);
}

std::string LineProcess::last_words() const {
  return said_.empty() ? "" : fmt::format("; its last words: {}", fmt::join(said_, " | "));
}

}  // namespace engram
