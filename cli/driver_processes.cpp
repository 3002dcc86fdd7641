// SPDX-License-Identifier: Apache-2.0
#include "cli/driver_processes.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
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
    reap(0);
  }

  [[nodiscard]] bool is_running() const { return id_ != 0; }
  [[nodiscard]] int output() const { return output_; }
  [[nodiscard]] const std::string& name() const { return driver_.name; }
  [[nodiscard]] bool is_due() const { return id_ == 0 && steady_now() >= again_; }

  Status start() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
      return unavailable("driver '{}': {}", name(), std::strerror(errno));
    const auto started =
        start_child(driver_.arguments, {.output = ends[1]}, ChildLife::kWithThread);
    ::close(ends[1]);
    if (!started.ok()) {
      ::close(ends[0]);
      return started.status().with_context(fmt::format("driver '{}'", name()));
    }
    id_ = *started;
    output_ = ends[0];
    begun_ = steady_now();
    return {};
  }

  void kill(int signal) const {
    if (id_ != 0) ::kill(id_, signal);
  }

  /// Reads what there is, and tells whole lines. Returns false at the end of the output.
  bool read(const DriverEvents& events) {
    std::array<char, 4096> bytes{};
    const ssize_t count = ::read(output_, bytes.data(), bytes.size());
    if (count < 0) return errno == EINTR || errno == EAGAIN;
    text_.append(bytes.data(), static_cast<size_t>(count));
    for (size_t end = 0; (end = text_.find('\n')) != std::string::npos; text_.erase(0, end + 1))
      events.on_line(name(), text_.substr(0, end));
    return count > 0;
  }

  /// Takes note that it ended, if it did. Returns its exit code.
  std::optional<int> reap(int flags) {
    int status = 0;
    pid_t ended = 0;
    do {
      ended = ::waitpid(id_, &status, flags);
    } while (ended < 0 && errno == EINTR);
    if (ended == 0) return std::nullopt;
    id_ = 0;
    text_.clear();
    ::close(std::exchange(output_, -1));
    pause_ = steady_now() - begun_ > kLivedWell ? kFirstPause
                                                : std::min<Duration>(2 * pause_, kMaxPause);
    again_ = steady_now() + pause_;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  [[nodiscard]] Duration pause() const { return pause_; }

 private:
  const DriverProcess& driver_;
  pid_t id_ = 0;
  int output_ = -1;
  std::string text_;  ///< An incomplete line.
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
    const auto code = one->reap(is_open ? WNOHANG : 0);
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
  // Drivers see by themselves that all is over; Ctrl-C does not reach them, because each has a
  // process group of its own.
  if (stop.stop_requested())
    for (const auto& one : all) one->kill(SIGTERM);
  const SteadyTime until = steady_now() + kGraceOfDrivers;
  while (!are_ended(all) && steady_now() < until) look_at(all, events, true);
  return {};
}

}  // namespace engram::cli
