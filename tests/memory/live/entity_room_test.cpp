// SPDX-License-Identifier: Apache-2.0
#include "memory/live/entity_room.h"

#include <gmock/gmock.h>

#include <thread>

#include "tests/ltm/expect_status.h"

namespace engram::memory {
namespace {

using ::testing::HasSubstr;

ltm::Commit commit_of(int i) {
  ltm::EntityUpdate update;
  update.entity = *ltm::MemoryId::parse(fmt::format("A/b/c/{}", i));
  update.time = time_from_ns(1);
  update.instances.push_back({idf::Data(int64_t{i}), {}});
  return {{std::move(update)}};
}

/// Half of the limit in working memory and in the store alike: their sum says that it is full.
class EntityRoomTest : public ::testing::Test {
 protected:
  static constexpr int kMax = 1000;

  void add(int i, bool is_recorded) {
    ASSERT_OK(memory_->commit(commit_of(i)));
    if (is_recorded) recorded_.correct(*ltm::MemoryId::parse(fmt::format("A/b/c/{}", i)), Time{});
  }

  std::unique_ptr<ltm::WorkingMemory> memory_ = *ltm::WorkingMemory::create({});
  ltm::RecordedEntities recorded_;
  EntityRoom room_{"A", kMax, *memory_, recorded_};
};

TEST_F(EntityRoomTest, CountsAllOnlyWhereThatDecides) {
  for (int i = 0; i < kMax; ++i) {
    ASSERT_OK(room_.admit(commit_of(i)));
    add(i, true);
  }
  EXPECT_EQ(room_.counts(), 1U) << "where the sum of both reached the limit";
  for (int i = 0; i < 100; ++i) {
    const Status refused = room_.admit(commit_of(kMax + i));
    ASSERT_EQ(refused.code(), StatusCode::kResourceExhausted);
    EXPECT_THAT(refused.message(), HasSubstr("has 1000 already, of at most 1000"));
    EXPECT_OK(room_.admit(commit_of(i)));  // A known one goes on.
  }
  // Slow machines may need another second.
  EXPECT_LE(room_.counts(), 5U);
}

TEST_F(EntityRoomTest, SeesThatThereIsRoomAgain) {
  for (int i = 0; i < kMax; ++i) {
    ASSERT_OK(room_.admit(commit_of(i)));
    add(i, true);
  }
  EXPECT_FALSE(room_.admit(commit_of(kMax)).ok());
  std::map<ltm::MemoryId, TimeSet> gone;
  for (int i = 0; i < 10; ++i) {
    const auto entity = *ltm::MemoryId::parse(fmt::format("A/b/c/{}", i));
    recorded_.correct(entity, std::nullopt);
    gone[entity].insert(time_from_ns(1));
  }
  memory_->forget(gone);
  Status admitted = room_.admit(commit_of(kMax));
  for (int attempt = 0; attempt < 100 && !admitted.ok(); ++attempt) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    admitted = room_.admit(commit_of(kMax));
  }
  EXPECT_OK(admitted);
}

}  // namespace
}  // namespace engram::memory
