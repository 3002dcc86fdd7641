// SPDX-License-Identifier: Apache-2.0
#include "cli/interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <thread>

#include "ltm/core/log.h"
#include "ltm/core/mutex.h"

namespace engram::cli {

namespace {

/// With what the system needs to end a large process this is below a second.
constexpr timespec kGrace{0, 700'000'000};

std::stop_source& source() {
  static std::stop_source instance;
  return instance;
}

struct Ending {
  Mutex mutex;
  std::string note ENGRAM_GUARDED_BY(mutex) = "nothing was changed";
};

/// Never destroyed: the thread that waits for signals outlives main().
Ending& ending() {
  static Ending& instance = *new Ending;
  return instance;
}

pthread_t waiter;
std::atomic<int> first_signal{0};
std::atomic<bool> ends_by_itself{false};
/// main() is over: what a log needs may be gone.
std::atomic<bool> is_ending{false};

/// Libraries start threads before main(), which may receive signals too and pass them on.
void hand_on(int signal) {
  pthread_kill(waiter, signal);
}

/// Destructors of the work that is under way do not run.
[[noreturn]] void cut_off(int signal) {
  if (is_ending) _exit(128 + signal);
  std::string note;
  {
    const MutexLock lock(ending().mutex);
    note = ending().note;
  }
  log::write(log::Level::kError, "stopped: " + note);
  _exit(128 + signal);
}

}  // namespace

void watch_for_interrupts() {
  // A signal handler may do almost nothing, so a thread of its own waits for the signals. Threads
  // that start later inherit the signal mask.
  static sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  (void)source();
  (void)ending();
  std::thread thread([] {
    int signal = 0;
    sigwait(&signals, &signal);
    first_signal = signal;
    source().request_stop();
    const int second =
        ends_by_itself ? sigwaitinfo(&signals, nullptr) : sigtimedwait(&signals, nullptr, &kGrace);
    cut_off(second > 0 ? second : signal);
  });
  waiter = thread.native_handle();
  thread.detach();
  struct sigaction action {};
  action.sa_handler = hand_on;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

std::stop_token interrupt_token() {
  return source().get_token();
}

void set_interrupt_note(std::string note) {
  const MutexLock lock(ending().mutex);
  ending().note = std::move(note);
}

void finish_after_interrupt() {
  ends_by_itself = true;
}

int end_interrupted_or(int exit_code) {
  is_ending = true;
  if (first_signal == 0 || ends_by_itself) return exit_code;
  // Libraries that learn take long to end, and crash where one of their threads is still at work.
  std::fflush(nullptr);
  _exit(128 + first_signal);
}

}  // namespace engram::cli
