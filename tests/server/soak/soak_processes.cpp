// SPDX-License-Identifier: Apache-2.0
#include "tests/server/soak/soak_processes.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>
#include <utility>

#include "ltm/core/check.h"

namespace engram::soak {

Process::Process(Process&& other) noexcept
    : words_(std::move(other.words_)),
      starts_(other.starts_),
      pid_(std::exchange(other.pid_, -1)) {}

Process::~Process() {
  kill();
}

void Process::start() {
  std::vector<std::string> words = words_;
  words.insert(words.begin(), "soak_server");
  words.push_back(std::to_string(starts_++));
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  ENGRAM_CHECK(pid_ >= 0, "cannot start a process");
  if (pid_ > 0) return;
  // Nothing is left behind where the parent is killed.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // One that is told to end before it listens is told when it does.
  sigset_t term;
  ::sigemptyset(&term);
  ::sigaddset(&term, SIGTERM);
  ::sigprocmask(SIG_BLOCK, &term, nullptr);
  if (::getppid() == parent) ::execv("/proc/self/exe", arguments.data());
  ::_exit(127);
}

void Process::kill() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(std::exchange(pid_, -1), nullptr, 0);
}

bool Process::end() {
  if (pid_ < 0) return true;
  ::kill(pid_, SIGTERM);
  for (int i = 0; i < 3000; ++i) {
    int state = 0;
    if (::waitpid(pid_, &state, WNOHANG) == pid_) {
      pid_ = -1;
      return WIFEXITED(state) && WEXITSTATUS(state) == 0;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill();
  return false;
}

bool Process::has_ended() {
  if (pid_ < 0 || ::waitpid(pid_, nullptr, WNOHANG) != pid_) return false;
  pid_ = -1;
  return true;
}

size_t Process::resident_bytes() const {
  std::ifstream file(fmt::format("/proc/{}/statm", pid_));
  size_t all = 0;
  size_t resident = 0;
  file >> all >> resident;
  return resident * static_cast<size_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace engram::soak
