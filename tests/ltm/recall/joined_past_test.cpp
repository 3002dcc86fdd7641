// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/joined_past.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <set>

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

constexpr int64_t kTimes = 40;

MemoryId entity() {
  return *MemoryId::parse("A/b/c/d");
}

SharedSnapshot held_at(int64_t at) {
  return hold_untyped({entity(), time_from_ns(at), {}});
}

/// Some of the times from 0 to kTimes.
std::set<int64_t> some(std::mt19937& random, uint32_t percent) {
  std::set<int64_t> times;
  for (int64_t at = 0; at <= kTimes; ++at)
    if (random() % 100 < percent) times.insert(at);
  return times;
}

/// A past in a list, as a store has it; what it answers says that it is stored.
class ListedPast final : public EntityPast {
 public:
  explicit ListedPast(std::set<int64_t> times) : times_(std::move(times)) {}

  Result<std::optional<Time>> first() override { return time(times_.begin()); }
  Result<std::optional<Time>> last() override {
    return time(times_.empty() ? times_.end() : std::prev(times_.end()));
  }
  Result<std::optional<Time>> at_or_after(Time from) override {
    return time(times_.lower_bound(to_ns(from)));
  }
  Result<std::optional<Time>> at_or_before(Time until) override {
    const auto behind = times_.upper_bound(to_ns(until));
    return time(behind == times_.begin() ? times_.end() : std::prev(behind));
  }
  Result<std::optional<Time>> nth(uint64_t index) override {
    return time(index < times_.size() ? std::next(times_.begin(), static_cast<int64_t>(index))
                                      : times_.end());
  }
  Result<uint64_t> count() override { return times_.size(); }
  Result<RecalledSnapshot> read(Time moment, Prefer /*prefer*/) override {
    RecalledSnapshot snapshot;
    snapshot.answer.time = moment;
    snapshot.answer.append(std::string("stored"), {});
    return snapshot;
  }
  Result<RecalledSnapshot> name(Time moment, Prefer prefer) override {
    return read(moment, prefer);
  }

 private:
  [[nodiscard]] std::optional<Time> time(std::set<int64_t>::const_iterator at) const {
    return at == times_.end() ? std::nullopt : std::optional(time_from_ns(*at));
  }

  std::set<int64_t> times_;
};

/// Held and stored moments, and all of them in one list.
struct Both {
  Both(const std::set<int64_t>& in_memory, std::set<int64_t> in_store)
      : stored(std::move(in_store)) {
    for (const int64_t at : in_memory) held.push_back(held_at(at));
    all = in_memory;
    all.insert(stored.begin(), stored.end());
    join();
  }

  /// Joins them anew, so that nothing was asked for yet.
  EntityPast& join() {
    joined = join_pasts({
        .newest = held.empty() ? nullptr : held.back(),
        .held =
            [this] {
              ++filled;
              return held;
            },
        .until =
            [this] {
              return stored.empty() ? std::nullopt : std::optional(time_from_ns(*stored.rbegin()));
            },
        .stored = [this]() -> Result<std::unique_ptr<EntityPast>> {
          ++opened;
          return std::unique_ptr<EntityPast>(std::make_unique<ListedPast>(stored));
        },
    });
    return *joined;
  }

  std::vector<SharedSnapshot> held;
  std::set<int64_t> stored;
  std::set<int64_t> all;
  std::unique_ptr<EntityPast> joined;
  int filled = 0;
  int opened = 0;
};

std::optional<Time> as_time(const std::set<int64_t>& times, std::set<int64_t>::const_iterator at) {
  return at == times.end() ? std::nullopt : std::optional(time_from_ns(*at));
}

/// All questions, each answered as one list would. `past` gives the past that each is asked of.
void expect_as_one(const std::set<int64_t>& all, const std::function<EntityPast&()>& past) {
  for (int64_t at = -1; at <= kTimes + 1; ++at) {
    EXPECT_EQ(*past().at_or_after(time_from_ns(at)), as_time(all, all.lower_bound(at)));
    const auto behind = all.upper_bound(at);
    EXPECT_EQ(*past().at_or_before(time_from_ns(at)),
              as_time(all, behind == all.begin() ? all.end() : std::prev(behind)));
  }
  EXPECT_EQ(*past().first(), as_time(all, all.begin()));
  EXPECT_EQ(*past().last(), as_time(all, all.empty() ? all.end() : std::prev(all.end())));
  EXPECT_EQ(*past().count(), all.size());
  auto next = all.begin();
  for (uint64_t index = 0; index < all.size() + 2; ++index) {
    EXPECT_EQ(*past().nth(index), as_time(all, next)) << "number " << index;
    if (next != all.end()) ++next;
  }
}

/// All questions to one past, and each to one that was not asked before.
void expect_as_one(Both&& both) {
  expect_as_one(both.all, [&]() -> EntityPast& { return *both.joined; });
  expect_as_one(both.all, [&]() -> EntityPast& { return both.join(); });
}

TEST(JoinedPast, AnswersAsOneListWould) {
  std::mt19937 random(11);
  for (int round = 0; round < 300; ++round) {
    expect_as_one(Both(some(random, random() % 101), some(random, random() % 101)));
    if (::testing::Test::HasFailure()) FAIL() << "in round " << round;
  }
}

TEST(JoinedPast, AnswersWhereNothingIsHeldOrStored) {
  expect_as_one(Both({}, {}));
  expect_as_one(Both({}, {1, 5}));
  expect_as_one(Both({2, 9}, {}));
}

TEST(JoinedPast, AsksTheStoreOnlyWhereItCouldChangeTheAnswer) {
  const Both both({6, 8, 9}, {1, 3, 6});
  EXPECT_EQ(*both.joined->last(), time_from_ns(9));
  EXPECT_EQ(*both.joined->at_or_before(time_from_ns(8)), time_from_ns(8));
  EXPECT_EQ(*both.joined->at_or_before(time_from_ns(7)), time_from_ns(6));
  EXPECT_EQ(*both.joined->at_or_after(time_from_ns(7)), time_from_ns(8));
  EXPECT_EQ(both.opened, 0);
  EXPECT_EQ(*both.joined->at_or_before(time_from_ns(5)), time_from_ns(3));
  EXPECT_EQ(*both.joined->first(), time_from_ns(1));
  EXPECT_EQ(both.opened, 1);
}

TEST(JoinedPast, AsksForAllThatIsHeldOnlyIfItMust) {
  Both both({6, 8, 9}, {1, 3, 6});
  EXPECT_EQ(*both.joined->last(), time_from_ns(9));
  EXPECT_EQ(*both.joined->at_or_before(time_from_ns(20)), time_from_ns(9));
  EXPECT_EQ(*both.joined->at_or_after(time_from_ns(9)), time_from_ns(9));
  EXPECT_EQ(both.joined->read(time_from_ns(9), Prefer::kRecorded)->held, both.held.back());
  EXPECT_EQ(both.filled, 0);
  EXPECT_EQ(*both.joined->at_or_before(time_from_ns(8)), time_from_ns(8));
  EXPECT_EQ(*both.joined->count(), 5u);
  EXPECT_EQ(both.filled, 1);
}

TEST(JoinedPast, MissesNothingThatLeavesMemoryMeanwhile) {
  const auto asked = [](auto ask) {
    Both both({6, 8, 9}, {1, 3});
    // It is recorded first, and then leaves.
    both.stored.insert(6);
    both.held.erase(both.held.begin());
    // What comes meanwhile is no part of it.
    both.held.push_back(held_at(12));
    EXPECT_EQ(ask(*both.joined), time_from_ns(6));
    EXPECT_EQ(*both.joined->last(), time_from_ns(9));
    EXPECT_EQ(*both.joined->count(), 5u);
  };
  asked([](EntityPast& past) { return *past.at_or_before(time_from_ns(7)); });
  asked([](EntityPast& past) { return *past.at_or_after(time_from_ns(4)); });
  asked([](EntityPast& past) { return *past.nth(2); });
}

TEST(JoinedPast, EndsWhereItEndedWhenItWasMade) {
  for (const std::set<int64_t>& held : {std::set<int64_t>{}, {3}, {2, 3}}) {
    Both both(held, {1, 3});
    // The store is opened after these were recorded.
    both.stored.insert({7, 9, 20});
    EntityPast& past = *both.joined;
    EXPECT_EQ(*past.at_or_after(time_from_ns(4)), std::nullopt);
    EXPECT_EQ(*past.at_or_before(time_from_ns(30)), time_from_ns(3));
    EXPECT_EQ(*past.last(), time_from_ns(3));
    EXPECT_EQ(*past.first(), time_from_ns(1));
    const uint64_t count = held.contains(2) ? 3 : 2;
    EXPECT_EQ(*past.count(), count);
    EXPECT_EQ(*past.nth(count - 1), time_from_ns(3));
    EXPECT_EQ(*past.nth(count), std::nullopt);
  }
}

TEST(JoinedPast, ReadsFromMemoryWhatBothHave) {
  const Both both({3, 7}, {3, 5});
  const auto held = both.joined->read(time_from_ns(3), Prefer::kRecorded);
  ASSERT_OK(held);
  EXPECT_EQ(held->held, both.held[0]);
  const auto stored = both.joined->read(time_from_ns(5), Prefer::kRecorded);
  ASSERT_OK(stored);
  EXPECT_EQ(stored->held, nullptr);
  EXPECT_EQ(stored->answer.instances[0].data, idf::Data("stored"));
}

}  // namespace
}  // namespace engram::ltm
