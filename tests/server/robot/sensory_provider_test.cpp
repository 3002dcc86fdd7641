// SPDX-License-Identifier: Apache-2.0
// Those who write into rings of sensory memory: what is lent to them, and what is left of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

#include "ltm/core/child.h"
#include "server/client/shared_lane.h"
#include "tests/server/robot/sensory_fixture.h"

namespace engram::server {
namespace {

using ::testing::ElementsAre;

class SensoryProvider : public Sensory {};

TEST_F(SensoryProvider, WhatAProviderWroteCanPassAfterItsEnd) {
  start(500ms);
  for (int64_t at = 1; at <= 3; ++at) ASSERT_OK(commit(kLeft, at));
  client_.reset();
  EXPECT_THAT(ask("Vision @ all"), ElementsAre(1, 2, 3));
  std::this_thread::sleep_for(800ms);
  EXPECT_EQ(running_.server->service().sensory()->source_count(), 1u) << "its ring is gone";
  EXPECT_EQ(counts().committed, 3u);
}

class SensoryLoan : public Sensory {
 protected:
  static std::vector<ArrayToLend> wanted(int64_t bytes) {
    return {{*ltm::MemoryId::parse(kLeft), idf::ElementType::kUInt8, {bytes, 3}},
            {*ltm::MemoryId::parse(kRight), idf::ElementType::kUInt8, {bytes}}};
  }

  static ltm::Commit commit_of_loan(const Loan& loan, int64_t at) {
    ltm::Commit commit;
    for (size_t eye = 0; eye < 2; ++eye) {
      std::ranges::fill(loan.bytes(eye), std::byte(at % 251));
      commit.updates.push_back({*ltm::MemoryId::parse(eye == 0 ? kLeft : kRight),
                                time_from_ns(at),
                                {{loan.array(eye), {}}}});
    }
    return commit;
  }
};

TEST_P(SensoryLoan, WhatIsWrittenThereIsHeldAndPasses) {
  start();
  int in_ring = 0;
  for (int64_t at = 1; at <= 40; ++at) {
    auto loan = client_->lend(wanted(50'000));
    ASSERT_OK(loan);
    in_ring += loan->is_in_ring();
    ASSERT_OK(client_->commit(commit_of_loan(*loan, at)));
    ASSERT_OK(client_->lend(wanted(70'000)));
  }
  EXPECT_EQ(in_ring, shares() ? 39 : 0) << "the first commit tells that its segment is sensory";
  EXPECT_EQ(counts().held, 80u);
  EXPECT_EQ(ask("Vision @ all").size(), 80u);
  EXPECT_EQ(counts().refused, 0u);
}

TEST_P(SensoryLoan, WhatIsCommittedOtherwiseIsCopied) {
  start();
  for (int64_t at = 1; at <= 2; ++at) {
    ASSERT_OK(commit(kLeft, at));
    ASSERT_OK(commit(kRight, at));
  }
  auto loan = client_->lend(wanted(20'000));
  ASSERT_OK(loan);
  ltm::Commit both = commit_of_loan(*loan, 3);
  ltm::Commit swapped = both;
  std::swap(swapped.updates[0].entity, swapped.updates[1].entity);
  std::swap(swapped.updates[0], swapped.updates[1]);
  ASSERT_OK(client_->commit(swapped));
  ltm::Commit one = both;
  one.updates.pop_back();
  one.updates[0].time = time_from_ns(4);
  std::ranges::fill(loan->bytes(0), std::byte(4));
  ASSERT_OK(client_->commit(one));
  std::ranges::fill(loan->bytes(0), std::byte(5));
  std::ranges::fill(loan->bytes(1), std::byte(5));
  for (ltm::EntityUpdate& update : both.updates) update.time = time_from_ns(5);
  ASSERT_OK(client_->commit(both));
  for (ltm::EntityUpdate& update : both.updates) update.time = time_from_ns(5 + 251);
  ASSERT_OK(client_->commit(both));
  EXPECT_THAT(ask(kLeft + std::string(" @ all")), ElementsAre(1, 2, 3, 4, 5, 256));
  EXPECT_THAT(ask(kRight + std::string(" @ all")), ElementsAre(1, 2, 3, 5, 256));
}

TEST_P(SensoryLoan, NamesWhatNoArrayCanHave) {
  start();
  auto arrays = wanted(10);
  arrays[1].shape = {-1, 3};
  EXPECT_FAILS(client_->lend(arrays), StatusCode::kInvalidArgument, kRight);
}

INSTANTIATE_TEST_SUITE_P(SharesMemory, SensoryLoan, ::testing::Bool());

TEST_F(SensoryProvider, NobodyElseCanMapARing) {
  start();
  for (int64_t at = 1; at <= 3; ++at) ASSERT_OK(commit(kLeft, at));
  // Not even who may read the memory, with any name of a slab.
  ClientOptions options;
  const auto channel = grpc::CreateChannel(running_.endpoint(), grpc::InsecureChannelCredentials());
  const auto stub = v1::MemoryServer::NewStub(channel);
  const auto other = SharedLane::open(*stub, options);
  ASSERT_NE(other, nullptr);
  for (SlabId slab = 1; slab < 10; ++slab) {
    const BlockRef block{slab, 0, 64, 1};
    EXPECT_FALSE(other->memory().readable(block, 64).ok()) << slab;
    EXPECT_FALSE(other->memory().writable(block).ok()) << slab;
  }
}

/// A provider in a process of its own, killed when this ends, at any moment of a write.
class Provider {
 public:
  explicit Provider(const std::string& endpoint) {
    int ends[2];
    EXPECT_EQ(::pipe(ends), 0);
    const auto child = start_child({ENGRAM_SENSORY_PEER, endpoint, kLeft}, {ends[1], {}});
    EXPECT_OK(child);
    pid_ = child.value_or(-1);
    ::close(ends[1]);
    char first = 0;
    EXPECT_EQ(::read(ends[0], &first, 1), 1) << "it did not begin to write";
    ::close(ends[0]);
  }
  Provider(const Provider&) = delete;
  Provider& operator=(const Provider&) = delete;
  ~Provider() {
    if (pid_ > 0 && ::kill(pid_, SIGKILL) == 0) ::waitpid(pid_, nullptr, 0);
  }

 private:
  pid_t pid_ = -1;
};

TEST_F(SensoryProvider, SurvivesProvidersThatAreKilledWhileTheyWrite) {
  start(500ms);
  uint64_t told_before = 0;
  for (int round = 0; round < 8; ++round) {
    ToldImages told;
    const auto consumer = running_.client();
    std::unique_ptr<Subscription> listening;
    const Time begin = system_now();
    {
      const Provider provider(running_.endpoint());
      auto subscribed = consumer->subscribe({.names = {kLeft}, .with_data = true}, told.handlers());
      ASSERT_OK(subscribed);
      listening = *std::move(subscribed);
      told.wait_for(20);
      std::this_thread::sleep_for(std::chrono::microseconds(700 * round + 13));
    }
    std::vector<int64_t> times = told.wait_for(20);
    // The ring of the one before is another, whose last images may come in between.
    std::erase_if(times, [&](int64_t time) { return time < to_ns(begin); });
    EXPECT_TRUE(std::ranges::is_sorted(times));
    for (size_t i = 1; i < times.size(); ++i) ASSERT_EQ(times[i], times[i - 1] + 1) << round;
    EXPECT_EQ(told.broken(), 0);
    told_before += times.size();
  }
  EXPECT_EQ(counts().refused, 0u);
  EXPECT_GE(counts().passed, told_before);
}
}  // namespace
}  // namespace engram::server
