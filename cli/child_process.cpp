// SPDX-License-Identifier: Apache-2.0
#include "cli/child_process.h"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <cerrno>
#include <memory>
#include <utility>

#include "cli/child_pipe.h"
#include "ltm/core/child.h"

namespace engram::cli {

namespace {

constexpr int kPollMs = 100;

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
    output_.close_write_end();
    errors_.close_write_end();
    if (!started.ok())
      return started.status().with_context("'" + child_.arguments.front() + "' cannot be started");
    id_ = *started;
    return {};
  }

  void add_to(std::vector<pollfd>& waiting) const {
    for (const ChildPipe* pipe : {&output_, &errors_})
      if (pipe->is_open()) waiting.push_back({pipe->read_end(), POLLIN, 0});
  }

  /// Reads from the pipes that poll() reported.
  void read(const std::vector<pollfd>& waiting) {
    for (const pollfd& one : waiting) {
      if (one.revents == 0) continue;
      if (one.fd == output_.read_end()) output_.read_into(child_.output);
      if (one.fd == errors_.read_end()) lines_.read(errors_, child_.on_error_line);
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
  ChildProcess& child_;
  pid_t id_ = 0;
  ChildPipe output_, errors_;
  ChildLines lines_;
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
