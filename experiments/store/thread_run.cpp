// SPDX-License-Identifier: Apache-2.0
#include "store/thread_run.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <latch>
#include <thread>

#include "ltm/core/check.h"

namespace engram::experiments {

namespace {

using Clock = std::chrono::steady_clock;

/// One thread's part of a pass.
struct Part {
  Clock::time_point begin, end;
  Spent spent;
  Status status;
};

Spent spent_by_thread() {
  rusage used{};
  ::getrusage(RUSAGE_THREAD, &used);
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return {static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec),
          static_cast<double>(used.ru_nvcsw)};
}

/// Each thread reads the clock itself, because the thread that started it may be late.
Part run_part(const Work& work) {
  Part part;
  const Spent before = spent_by_thread();
  part.begin = Clock::now();
  part.status = work();
  part.end = Clock::now();
  const Spent after = spent_by_thread();
  part.spent = {after.cpu_seconds - before.cpu_seconds, after.waits - before.waits};
  return part;
}

Result<Pass> join(const std::vector<Part>& parts) {
  Pass pass;
  Clock::time_point begin = parts.front().begin, end = parts.front().end;
  for (const Part& part : parts) {
    ENGRAM_RETURN_IF_ERROR(part.status);
    begin = std::min(begin, part.begin);
    end = std::max(end, part.end);
    pass.spent.cpu_seconds += part.spent.cpu_seconds;
    pass.spent.waits += part.spent.waits;
  }
  pass.seconds = std::chrono::duration<double>(end - begin).count();
  return pass;
}

}  // namespace

Result<Pass> run_threads(const Works& works, size_t threads) {
  ENGRAM_CHECK(threads > 0 && threads <= works.size(), "{} threads, {} works", threads,
               works.size());
  std::vector<Part> parts(threads);
  std::latch start(static_cast<std::ptrdiff_t>(threads));
  std::vector<std::jthread> running;
  for (size_t i = 0; i < threads; ++i)
    running.emplace_back([&, i] {
      start.arrive_and_wait();
      parts[i] = run_part(works[i]);
    });
  running.clear();
  return join(parts);
}

}  // namespace engram::experiments
