// SPDX-License-Identifier: Apache-2.0
#include "ltm/recording/worker_pool.h"

#include <gtest/gtest.h>

#include <atomic>

namespace engram::ltm {
namespace {

TEST(WorkerPool, DoesEveryPartOnceWhateverTheNumberOfThreads) {
  for (const int threads : {1, 2, 5}) {
    WorkerPool pool(threads);
    for (size_t count = 0; count < 200; ++count) {
      std::vector<std::atomic<int>> done(count);
      pool.run(count, [&](size_t i) { ++done[i]; });
      for (const auto& each : done) ASSERT_EQ(each, 1);
    }
  }
}

TEST(WorkerPool, WorksInParallel) {
  WorkerPool pool(2);
  std::atomic<int> arrived = 0;
  // Each part waits for the other: alone, the first would never end.
  pool.run(2, [&](size_t) {
    ++arrived;
    while (arrived < 2) std::this_thread::yield();
  });
  EXPECT_EQ(arrived, 2);
}

}  // namespace
}  // namespace engram::ltm
