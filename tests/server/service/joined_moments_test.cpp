// SPDX-License-Identifier: Apache-2.0
#include "server/service/joined_moments.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/ltm/expect_status.h"

namespace engram::server {
namespace {

constexpr int64_t kTimes = 40;

ltm::MemoryId entity() {
  return *ltm::MemoryId::parse("A/b/c/d");
}

SharedSnapshot held_at(int64_t at) {
  HeldSnapshot held;
  held.entity = entity();
  held.time = time_from_ns(at);
  return std::make_shared<const HeldSnapshot>(std::move(held));
}

/// Some of the times from 0 to kTimes.
std::set<int64_t> some(std::mt19937& random, uint32_t percent) {
  std::set<int64_t> times;
  for (int64_t at = 0; at <= kTimes; ++at)
    if (random() % 100 < percent) times.insert(at);
  return times;
}

/// Held and stored moments, and all of them in one list.
struct Both {
  Both(const std::set<int64_t>& in_memory, const std::set<int64_t>& in_store)
      : timeline(entity(), {}, entries(in_store), nullptr) {
    for (const int64_t at : in_memory) held.push_back(held_at(at));
    all = in_memory;
    all.insert(in_store.begin(), in_store.end());
  }

  static std::vector<ltm::SnapshotEntry> entries(const std::set<int64_t>& times) {
    std::vector<ltm::SnapshotEntry> made;
    for (const int64_t at : times) {
      made.push_back({time_from_ns(at), {}, {}});
      made.back().recorded.emplace();
    }
    return made;
  }

  std::vector<SharedSnapshot> held;
  ltm::Timeline timeline;
  std::set<int64_t> all;
};

std::optional<Time> as_time(const std::set<int64_t>& times, std::set<int64_t>::const_iterator at) {
  return at == times.end() ? std::nullopt : std::optional(time_from_ns(*at));
}

/// All questions, each answered as one list would.
void expect_as_one(const Both& both, JoinedMoments& joined) {
  const auto& all = both.all;
  EXPECT_EQ(joined.first(), as_time(all, all.begin()));
  EXPECT_EQ(joined.last(), as_time(all, all.empty() ? all.end() : std::prev(all.end())));
  for (int64_t at = -1; at <= kTimes + 1; ++at) {
    EXPECT_EQ(*joined.at_or_after(time_from_ns(at)), as_time(all, all.lower_bound(at)));
    const auto behind = all.upper_bound(at);
    EXPECT_EQ(*joined.at_or_before(time_from_ns(at)),
              as_time(all, behind == all.begin() ? all.end() : std::prev(behind)));
  }
  auto next = all.begin();
  for (uint64_t index = 0; index < all.size() + 2; ++index) {
    EXPECT_EQ(*joined.nth(index), as_time(all, next)) << "number " << index;
    if (next != all.end()) ++next;
  }
}

TEST(JoinedMoments, AnswerAsOneListWould) {
  std::mt19937 random(11);
  for (int round = 0; round < 300; ++round) {
    Both both(some(random, random() % 101), some(random, random() % 101));
    JoinedMoments joined(both.held, &both.timeline);
    expect_as_one(both, joined);
    if (::testing::Test::HasFailure()) FAIL() << "in round " << round;
  }
}

TEST(JoinedMoments, AnswerWhereNothingIsHeldOrStored) {
  Both nothing({}, {});
  JoinedMoments none(nothing.held, &nothing.timeline);
  expect_as_one(nothing, none);
  Both stored({}, {1, 5});
  JoinedMoments only_stored(stored.held, &stored.timeline);
  expect_as_one(stored, only_stored);
  Both held({2, 9}, {});
  JoinedMoments without_store(held.held, nullptr);
  expect_as_one(held, without_store);
}

TEST(JoinedMoments, FindWhatIsHeldAtExactlyThatTime) {
  Both both({3, 7}, {5});
  const JoinedMoments joined(both.held, &both.timeline);
  EXPECT_EQ(joined.find(time_from_ns(7)), both.held[1]);
  EXPECT_EQ(joined.find(time_from_ns(5)), nullptr);
  EXPECT_EQ(joined.find(time_from_ns(8)), nullptr);
}

}  // namespace
}  // namespace engram::server
