// SPDX-License-Identifier: Apache-2.0
#include "training/night/robot_busy.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>
#include <thread>
#include <vector>

#include "ltm/core/child.h"
#include "ltm/core/log.h"

namespace engram::training {

namespace {

using SteadyTime = std::chrono::steady_clock::time_point;

constexpr auto kPoll = std::chrono::milliseconds(10);

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) words.push_back(std::move(word));
  return words;
}

/// Starts a command whose stdout goes to /dev/null.
Result<pid_t> start(const std::vector<std::string>& words) {
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere < 0) return unavailable("/dev/null: {}", std::strerror(errno));
  auto child = start_child(words, {nowhere, {}});
  ::close(nowhere);
  return child;
}

}  // namespace

/// Runs a command repeatedly beside other work and keeps its last answer.
class RobotBusy::Command {
 public:
  Command(std::string text, Duration interval)
      : text_(std::move(text)), words_(words_of(text_)), interval_(interval) {}

  ~Command() {
    if (child_ != 0) end_child();
  }

  Status first_answer() {
    if (words_.empty()) return invalid_argument("yield command: found no word, needs a program");
    if (const Status started = ask(); !started.ok())
      return invalid_argument("yield command '{}': cannot be run: {}", text_, started.message());
    while (child_ != 0) {
      std::this_thread::sleep_for(kPoll);
      look();
    }
    return {};
  }

  bool is_busy() {
    look();
    if (child_ == 0 && std::chrono::steady_clock::now() >= next_) {
      if (const Status started = ask(); !started.ok()) answer(false, started.message());
    }
    return is_busy_;
  }

 private:
  Status ask() {
    ENGRAM_ASSIGN_OR_RETURN(child_, start(words_));
    late_ = std::chrono::steady_clock::now() + interval_;
    return {};
  }

  /// Takes the answer if the command has ended.
  void look() {
    if (child_ == 0) return;
    int status = 0;
    const pid_t ended = ::waitpid(child_, &status, WNOHANG);
    if (ended == 0) {
      if (std::chrono::steady_clock::now() < late_) return;
      end_child();
      return answer(false, fmt::format("took longer than {}", to_string(interval_)));
    }
    child_ = 0;
    if (ended < 0) return answer(false, std::strerror(errno));
    if (WIFSIGNALED(status))
      return answer(false, fmt::format("was ended by signal {}", WTERMSIG(status)));
    answer(WEXITSTATUS(status) == 0, {});
  }

  void answer(bool is_busy, const std::string& problem) {
    is_busy_ = is_busy;
    next_ = std::chrono::steady_clock::now() + interval_;
    if (!problem.empty() && !has_warned_)
      log::warning("yield command '{}': {}: counts as not busy", text_, problem);
    has_warned_ = !problem.empty();
  }

  void end_child() {
    // The whole process group is killed, because the command may have started children.
    ::kill(-child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
    child_ = 0;
  }

  std::string text_;
  std::vector<std::string> words_;
  Duration interval_;
  pid_t child_ = 0;  ///< Zero if none runs.
  SteadyTime late_{};
  SteadyTime next_{};
  bool is_busy_ = false;
  bool has_warned_ = false;
};

RobotBusy::RobotBusy(Options options) : options_(std::move(options)) {
  if (!options_.command.empty())
    command_ = std::make_unique<Command>(options_.command, options_.command_interval);
}

RobotBusy::~RobotBusy() = default;

Result<std::unique_ptr<RobotBusy>> RobotBusy::create(const Options& options) {
  std::unique_ptr<RobotBusy> busy(new RobotBusy(options));
  if (busy->command_) ENGRAM_RETURN_IF_ERROR(busy->command_->first_answer());
  return busy;
}

std::optional<std::string> RobotBusy::reason() {
  const auto now = std::chrono::steady_clock::now();
  if (!options_.file.empty() && now >= next_look_) {
    std::error_code unknown;
    has_file_ = std::filesystem::exists(options_.file, unknown);
    next_look_ = now + options_.file_interval;
  }
  if (has_file_) return options_.file.string() + " exists";
  if (command_ && command_->is_busy()) return fmt::format("'{}' says so", options_.command);
  return std::nullopt;
}

}  // namespace engram::training
