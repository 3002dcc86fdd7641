// SPDX-License-Identifier: Apache-2.0
#include "server/wire/polling_threads.h"

#include <gmock/gmock.h>

#include <future>
#include <thread>

#include "ltm/core/time.h"

namespace engram::server {
namespace {

using namespace std::chrono_literals;
using testing::Eq;

constexpr auto kSoon = 10s;

bool comes_true(const std::function<bool()>& condition) {
  for (const SteadyTime until = steady_now() + kSoon; steady_now() < until;) {
    if (condition()) return true;
    std::this_thread::sleep_for(1ms);
  }
  return false;
}

class PollingThreadsTest : public testing::Test {
 protected:
  void SetUp() override {
    if (std::thread::hardware_concurrency() >= 8) GTEST_SKIP() << "all of them work here";
    EXPECT_TRUE(comes_true([this] { return threads_.held() == 1; }));
  }

  PollingThreads& threads_ = PollingThreads::of_process();
};

TEST_F(PollingThreadsTest, HoldsOneWhileTheOtherAnswers) {
  for (int i = 0; i < 100; ++i) {
    std::promise<void> answered;
    PollingThreads::call([&] { answered.set_value(); });
    ASSERT_THAT(answered.get_future().wait_for(kSoon), Eq(std::future_status::ready));
  }
}

TEST_F(PollingThreadsTest, AHandlerThatWaitsForAnotherIsNotWaitedForForever) {
  std::promise<void> first;
  std::promise<bool> second;
  PollingThreads::call(
      [&] { second.set_value(first.get_future().wait_for(kSoon) == std::future_status::ready); });
  PollingThreads::call([&] { first.set_value(); });
  EXPECT_TRUE(second.get_future().get());
  EXPECT_TRUE(comes_true([this] { return threads_.held() == 1; }));
}

TEST_F(PollingThreadsTest, AHandlerThatSaysThatItWaitsLetsAllWork) {
  std::promise<int> blocked;
  std::promise<int> held;
  PollingThreads::call([&] {
    const BlockingScope blocking;
    blocked.set_value(threads_.blocked());
    held.set_value(comes_true([this] { return threads_.held() == 0; }) ? 0 : threads_.held());
  });
  EXPECT_THAT(blocked.get_future().get(), Eq(1));
  EXPECT_THAT(held.get_future().get(), Eq(0));
  EXPECT_TRUE(comes_true([this] { return threads_.blocked() == 0; }));
}

}  // namespace
}  // namespace engram::server
