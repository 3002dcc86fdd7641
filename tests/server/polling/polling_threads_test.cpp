// SPDX-License-Identifier: Apache-2.0
#include "server/polling/polling_threads.h"

#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>

#include <future>
#include <memory>
#include <thread>

#include "ltm/core/time.h"

namespace engram::server {
namespace {

using namespace std::chrono_literals;
using testing::Eq;

constexpr auto kSoon = 10s;

/// Calls without a connection, which gRPC answers in its threads.
class Calls {
 public:
  void call(std::function<void()> back) {
    struct Call {
      grpc::ClientContext context;
      grpc::Slice nothing;
      grpc::ByteBuffer request{&nothing, 1};
      grpc::ByteBuffer reply;
    };
    auto call = std::make_shared<Call>();
    stub_.UnaryCall(&call->context, "/engram/Test", {}, &call->request, &call->reply,
                    [call, back = std::move(back)](const grpc::Status&) { back(); });
  }

 private:
  grpc::GenericStub stub_{grpc::CreateCustomChannel("nowhere", nullptr, grpc::ChannelArguments())};
};

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
  Calls calls_;
};

TEST_F(PollingThreadsTest, HoldsOneWhileTheOtherAnswers) {
  for (int i = 0; i < 100; ++i) {
    std::promise<void> answered;
    calls_.call([&] { answered.set_value(); });
    ASSERT_THAT(answered.get_future().wait_for(kSoon), Eq(std::future_status::ready));
  }
}

TEST_F(PollingThreadsTest, AHandlerThatWaitsForAnotherIsNotWaitedForForever) {
  std::promise<void> first;
  std::promise<bool> second;
  calls_.call(
      [&] { second.set_value(first.get_future().wait_for(kSoon) == std::future_status::ready); });
  calls_.call([&] { first.set_value(); });
  EXPECT_TRUE(second.get_future().get());
  EXPECT_TRUE(comes_true([this] { return threads_.held() == 1; }));
}

TEST_F(PollingThreadsTest, AHandlerThatSaysThatItWaitsIsWaitedForAtOnce) {
  std::promise<Duration> waited;
  // By now the thread that works has answered: it is known as one of them.
  calls_.call([&] {
    std::promise<void> inner;
    const SteadyTime began = steady_now();
    {
      const BlockingScope blocking;
      calls_.call([&] { inner.set_value(); });
      inner.get_future().wait_for(kSoon);
    }
    waited.set_value(steady_now() - began);
  });
  EXPECT_LT(waited.get_future().get(), kSoon);
}

}  // namespace
}  // namespace engram::server
