// SPDX-License-Identifier: Apache-2.0
#include "server/client/robot_waits.h"

#include <gmock/gmock.h>

#include <atomic>
#include <thread>

#include "tests/ltm/expect_status.h"

namespace engram::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(PendingReplies, GivesWhatEachSaidAndEndsWithTheLastOne) {
  PendingReplies pending(2, unavailable("no answer"));
  std::jthread other([&] {
    pending.set(1, data_loss("broken"));
    pending.set(0, {});
  });
  const auto statuses = pending.wait(steady_now() + seconds(60));
  ASSERT_EQ(statuses.size(), 2);
  EXPECT_OK(statuses[0]);
  EXPECT_FAILS(statuses[1], StatusCode::kDataLoss, "broken");
}

TEST(PendingReplies, TellsWhoSaidNothingUntilTheDeadline) {
  PendingReplies pending(2, unavailable("no answer"));
  pending.set(0, {});
  const auto statuses = pending.wait(steady_now() + milliseconds(5));
  ASSERT_EQ(statuses.size(), 2);
  EXPECT_OK(statuses[0]);
  EXPECT_FAILS(statuses[1], StatusCode::kUnavailable, "no answer");
  // What comes late waits for nobody who still works with the answers.
  pending.set(1, {});
  EXPECT_OK(pending.wait(steady_now())[1]);
  EXPECT_FALSE(statuses[1].ok());
}

TEST(Backoff, WaitsWhereThereIsTimeAndNotElsewhere) {
  const SteadyTime begun = steady_now();
  Backoff backoff(begun + std::chrono::hours(1));
  EXPECT_TRUE(backoff.wait());
  EXPECT_GE(steady_now() - begun, kFirstWait);
  Backoff none(steady_now() + kFirstWait / 2);
  EXPECT_FALSE(none.wait()) << "it would end behind the deadline";
}

TEST(AtOnce, DoesEachOnceAndAllTogether) {
  std::atomic<int> inside{0};
  std::atomic<int> calls{0};
  at_once(3, [&](size_t) {
    ++inside;
    // Returns where the others come too.
    while (inside < 3) std::this_thread::yield();
    ++calls;
  });
  EXPECT_EQ(calls, 3);
  at_once(0, [&](size_t) { ++calls; });
  EXPECT_EQ(calls, 3);
}

}  // namespace
}  // namespace engram::server
