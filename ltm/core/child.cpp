// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace engram {

namespace {

/// What a child does before it is another program. It still has its parent's memory then, as after
/// posix_spawn, which cannot set a signal for the parent's death: a copy of that memory, as fork
/// makes it, takes long where a network is learned. So nothing here may change memory or take a
/// lock; the calls are the kernel's. Sanitizers make a fork of it, so that the error comes by a
/// pipe.
struct ChildPlan {
  char* const* argv;
  ChildStreams streams;
  ChildLife life;
  pid_t parent;
  int failed;  ///< The error is written there.

  void move_to(int from, int to) const {
    if (from == to)
      ::fcntl(from, F_SETFD, 0);
    else
      ::dup2(from, to);
  }

  /// Returns the error if it stays what it is.
  [[nodiscard]] int become() const {
    ::setpgid(0, 0);
    if (life == ChildLife::kWithThread) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (::getppid() != parent) return ESRCH;
    }
    // The parent may block the signals that end it, and ignore others; the child must not inherit
    // this.
    struct sigaction standard {};
    standard.sa_handler = SIG_DFL;
    for (int number = 1; number < NSIG; ++number) ::sigaction(number, &standard, nullptr);
    const int input = streams.input ? *streams.input : ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    move_to(input, STDIN_FILENO);
    if (streams.output) move_to(*streams.output, STDOUT_FILENO);
    if (streams.errors) move_to(*streams.errors, STDERR_FILENO);
#ifdef SYS_close_range
    // Libraries open files without a thought of children.
    constexpr unsigned kCloseOnExec = 4;
    ::syscall(SYS_close_range, 3U, ~0U, kCloseOnExec);
#endif
    sigset_t none;
    sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    ::execvp(argv[0], argv);
    return errno;
  }
};

/// Nothing else is in its frame, which the child must not change.
[[gnu::noinline]] pid_t start(const ChildPlan& plan) {
  const pid_t child = ::vfork();
  if (child == 0) {
    const int error = plan.become();
    [[maybe_unused]] const ssize_t told = ::write(plan.failed, &error, sizeof(error));
    ::_exit(127);
  }
  return child;
}

/// The error that a child told before it could become a program; 0: it did.
int told_error(int failed) {
  int error = 0;
  ssize_t got = 0;
  do {
    got = ::read(failed, &error, sizeof(error));
  } while (got < 0 && errno == EINTR);
  return got == sizeof(error) ? error : 0;
}

}  // namespace

Result<pid_t> start_child(const std::vector<std::string>& words, const ChildStreams& streams,
                          ChildLife life) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  std::array<int, 2> failed{};
  if (::pipe2(failed.data(), O_CLOEXEC) != 0) return unavailable("{}", std::strerror(errno));
  // A handler must not run in the child, which has the memory of this process.
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t child = start({argv.data(), streams, life, ::getpid(), failed[1]});
  const int error_of_fork = child < 0 ? errno : 0;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  ::close(failed[1]);
  const int error = child < 0 ? error_of_fork : told_error(failed[0]);
  ::close(failed[0]);
  if (error == 0) return child;
  while (child > 0 && ::waitpid(child, nullptr, 0) < 0 && errno == EINTR) continue;
  const std::string reason = std::strerror(error);
  return error == ENOENT ? not_found("{}", reason) : unavailable("{}", reason);
}

}  // namespace engram
