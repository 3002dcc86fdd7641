// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/map_feed.h"

#include <gtest/gtest.h>

#include "server/navigation/cost_map_provider.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/server/navigation/floor_example.h"
#include "tests/server/navigation/hooked_memory.h"

namespace engram::navigation {
namespace {

using std::chrono::seconds;
using testing::kBegin;
using testing::thing_at;

class MapFeedTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = Memory::open(scratch / "robot.engram");
    ASSERT_OK(opened);
    memory = std::make_unique<testing::HookedMemory>(*std::move(opened));
    ASSERT_OK(memory->commit({{testing::class_of("chair", "box", 0.5, 0.5, 0.9),
                               thing_at("chair_1", "chair", {-2, 0, 0}, 0.45, kBegin)}},
                             CommitDurability::kMemory));
    auto started = CostMapProvider::start(*memory, {});
    ASSERT_OK(started);
    provider = *std::move(started);
  }

  /// Puts the chair somewhere, and waits for the map of it.
  void put_chair(const PlanarPose& pose, Time time) {
    ASSERT_OK(memory->commit({{thing_at("chair_1", "chair", pose, 0.45, time)}},
                             CommitDurability::kMemory));
    ASSERT_TRUE(provider->wait_for(testing::thing_id("chair_1").at(time), seconds(20)));
  }

  ScratchDirectory scratch;
  std::unique_ptr<testing::HookedMemory> memory;
  std::unique_ptr<CostMapProvider> provider;
};

TEST_F(MapFeedTest, HasTheMapThatWasThereAndEachThatComes) {
  const auto feed = MapFeed::open(*memory, MapRules{}.entity());
  ASSERT_OK(feed);
  EXPECT_EQ((*feed)->latest()->id, provider->latest().id);
  put_chair({1, 1, 0}, kBegin + seconds(1));
  ASSERT_TRUE((*feed)->wait_for(kBegin + seconds(1), seconds(20)));
  EXPECT_EQ((*feed)->latest()->cost_at({1, 1}), kLethalCost);
  EXPECT_FALSE((*feed)->wait_for(kBegin + seconds(2), std::chrono::milliseconds(10)));
}

TEST_F(MapFeedTest, AsksForAMapThatItWasToldOfWithoutItsData) {
  memory->inline_bytes = 100;
  const auto feed = MapFeed::open(*memory, MapRules{}.entity());
  ASSERT_OK(feed);
  int questions = 0;
  memory->on_query = [&]() -> Status {
    ++questions;
    return {};
  };
  put_chair({1, 1, 0}, kBegin + seconds(1));
  // What it is told comes when it comes; until then the old map is the newest that it knows.
  std::shared_ptr<const CostMap> map = (*feed)->latest();
  for (int i = 0; i < 2000 && map->id.time() < kBegin + seconds(1); ++i) {
    EXPECT_FALSE((*feed)->wait_for(kBegin + seconds(1), std::chrono::milliseconds(1)));
    map = (*feed)->latest();
  }
  EXPECT_EQ(map->cost_at({1, 1}), kLethalCost);
  EXPECT_EQ(questions, 1);
  EXPECT_EQ((*feed)->latest(), map);
  EXPECT_EQ(questions, 1);
}

TEST_F(MapFeedTest, KeepsTheMapThatItKnowsWhileTheMemoryFails) {
  memory->inline_bytes = 100;
  const auto feed = MapFeed::open(*memory, MapRules{}.entity());
  ASSERT_OK(feed);
  bool is_away = true;
  int refused = 0;
  memory->on_query = [&]() -> Status {
    refused += is_away ? 1 : 0;
    return is_away ? unavailable("the server is away") : Status();
  };
  const auto before = (*feed)->latest();
  put_chair({1, 1, 0}, kBegin + seconds(1));
  for (int i = 0; i < 2000 && refused == 0; ++i) {
    EXPECT_EQ((*feed)->latest(), before);
    EXPECT_FALSE((*feed)->wait_for(kBegin + seconds(1), std::chrono::milliseconds(1)));
  }
  EXPECT_GT(refused, 0);
  is_away = false;
  EXPECT_EQ((*feed)->latest()->cost_at({1, 1}), kLethalCost);
}

}  // namespace
}  // namespace engram::navigation
