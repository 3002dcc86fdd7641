// SPDX-License-Identifier: Apache-2.0
#include "tests/cli/run_program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>

namespace engram::cli {

namespace {

using WallClock = std::chrono::steady_clock;

struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) std::abort();
  }
  ~Pipe() {
    for (const int end : ends)
      if (end >= 0) ::close(end);
  }
  void close_writer() {
    ::close(ends[1]);
    ends[1] = -1;
  }
};

pid_t start(const std::vector<std::string>& arguments, const Pipe& out, const Pipe& err) {
  std::vector<char*> argv{const_cast<char*>("engram")};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(out.ends[1], STDOUT_FILENO);
    ::dup2(err.ends[1], STDERR_FILENO);
    ::execv(ENGRAM_PROGRAM, argv.data());
    ::_exit(127);
  }
  return child;
}

/// Appends what is there; false at the end.
bool drain(const pollfd& ready, std::string& text) {
  if ((ready.revents & (POLLIN | POLLHUP)) == 0) return true;
  std::array<char, 65536> piece;
  const ssize_t count = ::read(ready.fd, piece.data(), piece.size());
  if (count > 0) text.append(piece.data(), static_cast<size_t>(count));
  return count > 0;
}

RunResult run(const std::vector<std::string>& arguments, int kill_after_ms,
              const std::string& kill_at) {
  Pipe out, err;
  const pid_t child = start(arguments, out, err);
  out.close_writer();
  err.close_writer();
  RunResult result;
  bool has_out = true, has_err = true, is_killed = false;
  const auto begin = WallClock::now();
  while (has_out || has_err) {
    std::array<pollfd, 2> ready{{{has_out ? out.ends[0] : -1, POLLIN, 0},
                                 {has_err ? err.ends[0] : -1, POLLIN, 0}}};
    ::poll(ready.data(), ready.size(), 5);
    if (has_out) has_out = drain(ready[0], result.out);
    if (has_err) has_err = drain(ready[1], result.err);
    const bool is_late = kill_after_ms >= 0 &&
                         WallClock::now() - begin >= std::chrono::milliseconds(kill_after_ms);
    const bool is_there = !kill_at.empty() && (result.err.find(kill_at) != std::string::npos ||
                                               result.out.find(kill_at) != std::string::npos);
    if (!is_killed && (is_late || is_there)) {
      ::kill(child, SIGKILL);
      is_killed = true;
    }
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  result.exit_code = WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  return result;
}

}  // namespace

struct RunningEngram::State {
  Pipe out, err;
  pid_t child = -1;
  RunResult result;
  bool has_out = true;
  bool has_err = true;

  /// False when both are closed.
  bool read_some() {
    std::array<pollfd, 2> ready{{{has_out ? out.ends[0] : -1, POLLIN, 0},
                                 {has_err ? err.ends[0] : -1, POLLIN, 0}}};
    ::poll(ready.data(), ready.size(), 50);
    if (has_out) has_out = drain(ready[0], result.out);
    if (has_err) has_err = drain(ready[1], result.err);
    return has_out || has_err;
  }
};

RunningEngram::RunningEngram(const std::vector<std::string>& arguments)
    : state_(std::make_unique<State>()) {
  state_->child = start(arguments, state_->out, state_->err);
  state_->out.close_writer();
  state_->err.close_writer();
}

RunningEngram::~RunningEngram() {
  if (state_->child > 0) end(SIGKILL);
}

bool RunningEngram::wait_for(const std::string& text) {
  const auto begin = WallClock::now();
  while (WallClock::now() - begin < std::chrono::seconds(30)) {
    if (state_->result.out.find(text) != std::string::npos ||
        state_->result.err.find(text) != std::string::npos)
      return true;
    if (!state_->read_some()) return false;
  }
  return false;
}

const std::string& RunningEngram::out() const {
  return state_->result.out;
}

RunResult RunningEngram::end(int signal) {
  if (signal != 0) ::kill(state_->child, signal);
  while (state_->read_some()) {
  }
  int status = 0;
  ::waitpid(state_->child, &status, 0);
  state_->child = -1;
  state_->result.exit_code = WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  return state_->result;
}

RunResult run_engram(const std::vector<std::string>& arguments) { return run(arguments, -1, ""); }

RunResult run_engram_and_kill(const std::vector<std::string>& arguments, int milliseconds,
                              const std::string& until) {
  return run(arguments, milliseconds, until);
}

Recording make_recording(const std::filesystem::path& directory, int seconds) {
  const Recording recording{directory / "scene.mp4", directory / "scene.csv"};
  const RunResult made =
      run_engram({"simulate", "scene", "--seconds", std::to_string(seconds), "--width", "64",
                  "--height", "64", "--video", recording.video, "--table", recording.table});
  if (made.exit_code != 0) std::abort();
  return recording;
}

std::vector<std::string> import_arguments(const Recording& recording, const std::string& store,
                                          const std::string& start) {
  return {"import",        "--video", recording.video,  "--table", recording.table, "--entity",
          kCamera,         "--state-entity", kJoints,   "--rate",  "5",             "--start",
          start,           store};
}

}  // namespace engram::cli
