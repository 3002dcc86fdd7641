// SPDX-License-Identifier: Apache-2.0
#include "cli/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "ltm/core/child.h"

namespace engram::cli {

namespace {

constexpr int kPollMs = 100;

/// A pipe that a child writes. The read end is not inherited by other children.
class Pipe {
 public:
  Pipe() = default;
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_end(0);
    close_end(1);
  }

  Status open() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0) return unavailable("pipe: {}", std::strerror(errno));
    return {};
  }

  [[nodiscard]] int read_end() const { return ends_[0]; }
  [[nodiscard]] int write_end() const { return ends_[1]; }
  [[nodiscard]] bool is_open() const { return ends_[0] >= 0; }
  void close_end(size_t i) {
    if (ends_[i] >= 0) ::close(ends_[i]);
    ends_[i] = -1;
  }

  /// Appends the available bytes, and closes the pipe at its end.
  void read_into(std::string& text) {
    std::array<char, 4096> bytes{};
    const ssize_t count = ::read(read_end(), bytes.data(), bytes.size());
    if (count > 0) text.append(bytes.data(), static_cast<size_t>(count));
    if (count == 0 || (count < 0 && errno != EINTR && errno != EAGAIN)) close_end(0);
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

/// A running child.
class Running {
 public:
  explicit Running(ChildProcess& child) : child_(child) {}
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running() {
    if (id_ == 0) return;
    end();
    wait();
  }

  Status start() {
    ENGRAM_RETURN_IF_ERROR(output_.open());
    ENGRAM_RETURN_IF_ERROR(errors_.open());
    const auto started = start_child(child_.arguments, {output_.write_end(), errors_.write_end()});
    output_.close_end(1);
    errors_.close_end(1);
    if (!started.ok())
      return started.status().with_context("'" + child_.arguments.front() + "' cannot be started");
    id_ = *started;
    return {};
  }

  void add_to(std::vector<pollfd>& waiting) const {
    for (const Pipe* pipe : {&output_, &errors_})
      if (pipe->is_open()) waiting.push_back({pipe->read_end(), POLLIN, 0});
  }

  /// Reads from the pipes that poll() reported.
  void read(const std::vector<pollfd>& waiting) {
    for (const pollfd& one : waiting) {
      if (one.revents == 0) continue;
      if (one.fd == output_.read_end()) output_.read_into(child_.output);
      if (one.fd == errors_.read_end()) {
        errors_.read_into(line_);
        tell_lines(!errors_.is_open());
      }
    }
  }

  void end() const { ::kill(id_, SIGTERM); }

  void wait() {
    int status = 0;
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = 0;
    child_.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  void tell_lines(bool is_end) {
    for (size_t end = 0; (end = line_.find('\n')) != std::string::npos; line_.erase(0, end + 1))
      child_.on_error_line(line_.substr(0, end));
    if (is_end && !line_.empty()) child_.on_error_line(std::exchange(line_, {}));
  }

  ChildProcess& child_;
  pid_t id_ = 0;
  Pipe output_, errors_;
  std::string line_;  ///< An incomplete line of stderr.
};

}  // namespace

Status run_children(std::vector<ChildProcess>& children, const std::stop_token& stop) {
  std::vector<std::unique_ptr<Running>> running;
  for (ChildProcess& child : children) {
    running.push_back(std::make_unique<Running>(child));
    ENGRAM_RETURN_IF_ERROR(running.back()->start());
  }
  bool is_told = false;
  for (;;) {
    std::vector<pollfd> waiting;
    for (const auto& one : running) one->add_to(waiting);
    if (waiting.empty()) break;
    // Children are in process groups of their own, which Ctrl-C on the terminal does not reach.
    if (stop.stop_requested() && !std::exchange(is_told, true))
      for (const auto& one : running) one->end();
    if (::poll(waiting.data(), waiting.size(), kPollMs) <= 0) continue;
    for (const auto& one : running) one->read(waiting);
  }
  for (const auto& one : running) one->wait();
  return {};
}

void end_with_parent() {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
}

}  // namespace engram::cli
