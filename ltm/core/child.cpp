// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/child.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace engram {

namespace {

/// What a child does before it is another program. It still has its parent's memory then, as after
/// posix_spawn, which cannot set a signal for the parent's death: a copy of that memory, as fork
/// makes it, takes long where a network is learned. So nothing here may change memory or take a
/// lock; the calls are the kernel's.
struct ChildPlan {
  char* const* argv;
  ChildStreams streams;
  ChildLife life;
  pid_t parent;

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

/// Its frame must not be left by the child, and so has nothing else in it.
[[gnu::noinline]] pid_t start(const ChildPlan& plan, volatile int& error) {
  const pid_t child = ::vfork();
  if (child == 0) {
    error = plan.become();
    ::_exit(127);
  }
  return child;
}

}  // namespace

Result<pid_t> start_child(const std::vector<std::string>& words, const ChildStreams& streams,
                          ChildLife life) {
  std::vector<char*> argv;
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  // A handler must not run in the child, which has the memory of this process.
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  volatile int error = 0;
  const pid_t child = start({argv.data(), streams, life, ::getpid()}, error);
  if (child < 0) error = errno;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (error == 0) return child;
  while (child > 0 && ::waitpid(child, nullptr, 0) < 0 && errno == EINTR) continue;
  const std::string reason = std::strerror(error);
  return error == ENOENT ? not_found("{}", reason) : unavailable("{}", reason);
}

}  // namespace engram
