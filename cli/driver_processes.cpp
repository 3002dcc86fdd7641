// SPDX-License-Identifier: Apache-2.0
#include "cli/driver_processes.h"

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <optional>

#include "cli/child_pipe.h"
#include "ltm/core/child.h"

namespace engram::cli {

namespace {

constexpr int kLookMs = 50;
constexpr Duration kGraceOfDrivers = std::chrono::seconds(2);
/// A driver that ends again at once waits longer each time, so that it does not fill the log.
constexpr Duration kFirstPause = std::chrono::milliseconds(200);
constexpr Duration kMaxPause = std::chrono::seconds(10);
constexpr Duration kLivedWell = std::chrono::seconds(5);

/// A driver, running or waiting to be started again.
class RunningDriver {
 public:
  explicit RunningDriver(const DriverProcess& driver) : driver_(driver) {}
  RunningDriver(const RunningDriver&) = delete;
  RunningDriver& operator=(const RunningDriver&) = delete;
  ~RunningDriver() {
    if (id_ == 0) return;
    kill(SIGKILL);
    reap(0, {});
  }

  [[nodiscard]] bool is_running() const { return id_ != 0; }
  [[nodiscard]] int output() const { return output_.read_end(); }
  [[nodiscard]] const std::string& name() const { return driver_.name; }
  [[nodiscard]] bool ends_by_itself() const { return driver_.ends_by_itself; }
  [[nodiscard]] bool is_due() const { return id_ == 0 && steady_now() >= again_; }

  Status start() {
    const std::string context = fmt::format("driver '{}'", name());
    if (const Status opened = output_.open(); !opened.ok()) return opened.with_context(context);
    const auto started =
        start_child(driver_.arguments, {.output = output_.write_end()}, ChildLife::kWithThread);
    output_.close_write_end();
    if (!started.ok()) {
      output_.close();
      return started.status().with_context(context);
    }
    id_ = *started;
    begun_ = steady_now();
    return {};
  }

  void kill(int signal) const {
    if (id_ != 0) ::kill(id_, signal);
  }

  /// Reads what there is, and tells whole lines. Returns false at the end of the output.
  bool read(const DriverEvents& events) {
    lines_.read(output_, [&](const std::string& line) { events.on_line(name(), line); });
    return output_.is_open();
  }

  /// Takes note that it ended, if it did, after what it said. Returns its exit code.
  std::optional<int> reap(int flags, const DriverEvents& events) {
    int status = 0;
    pid_t ended = 0;
    do {
      ended = ::waitpid(id_, &status, flags);
    } while (ended < 0 && errno == EINTR);
    if (ended == 0) return std::nullopt;
    id_ = 0;
    // One that was killed may have left lines. Nobody writes any more, so this does not wait.
    while (events.on_line && output_.is_open() && output_.has_bytes()) read(events);
    output_.close();
    lines_.clear();
    pause_ = steady_now() - begun_ > kLivedWell ? kFirstPause
                                                : std::min<Duration>(2 * pause_, kMaxPause);
    again_ = steady_now() + pause_;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  [[nodiscard]] Duration pause() const { return pause_; }

 private:
  const DriverProcess& driver_;
  pid_t id_ = 0;
  ChildPipe output_;
  ChildLines lines_;
  SteadyTime begun_{};
  SteadyTime again_{};
  Duration pause_ = kFirstPause / 2;
};

using RunningDrivers = std::vector<std::unique_ptr<RunningDriver>>;

/// Reads what drivers say for a while, and takes note of those that ended.
void look_at(const RunningDrivers& all, const DriverEvents& events, bool is_ending) {
  std::vector<pollfd> waiting;
  for (const auto& one : all)
    if (one->is_running()) waiting.push_back({one->output(), POLLIN, 0});
  if (::poll(waiting.data(), waiting.size(), kLookMs) < 0) return;
  for (const auto& one : all) {
    if (!one->is_running()) continue;
    bool is_open = true;
    for (const pollfd& ready : waiting)
      if (ready.fd == one->output() && ready.revents != 0) is_open = one->read(events);
    // A driver ends by closing its output; one that is killed may leave lines.
    const auto code = one->reap(is_open ? WNOHANG : 0, events);
    if (code && !is_ending && !events.is_over()) events.on_end(one->name(), *code, one->pause());
  }
}

bool are_ended(const RunningDrivers& all) {
  for (const auto& one : all)
    if (one->is_running()) return false;
  return true;
}

}  // namespace

Status run_drivers(const std::vector<DriverProcess>& drivers, const DriverEvents& events,
                   const std::stop_token& stop) {
  RunningDrivers all;
  for (const DriverProcess& driver : drivers) {
    all.push_back(std::make_unique<RunningDriver>(driver));
    ENGRAM_RETURN_IF_ERROR(all.back()->start());
  }
  while (!stop.stop_requested() && !events.is_over()) {
    look_at(all, events, false);
    events.on_look();
    for (const auto& one : all)
      if (one->is_due() && !events.is_over()) ENGRAM_RETURN_IF_ERROR(one->start());
  }
  // Ctrl-C does not reach drivers, because each has a process group of its own.
  for (const auto& one : all)
    if (stop.stop_requested() || !one->ends_by_itself()) one->kill(SIGTERM);
  const SteadyTime until = steady_now() + kGraceOfDrivers;
  while (!are_ended(all) && steady_now() < until) look_at(all, events, true);
  return {};
}

}  // namespace engram::cli
