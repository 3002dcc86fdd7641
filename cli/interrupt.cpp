// SPDX-License-Identifier: Apache-2.0
#include "cli/interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <thread>

namespace engram::cli {

namespace {

std::stop_source& source() {
  static std::stop_source instance;
  return instance;
}

pthread_t waiter;

/// Libraries start threads before main(), which may receive signals too and pass them on.
void hand_on(int signal) {
  pthread_kill(waiter, signal);
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
  std::thread thread([] {
    int signal = 0;
    sigwait(&signals, &signal);
    source().request_stop();
    sigwait(&signals, &signal);
    _exit(128 + signal);
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

}  // namespace engram::cli
