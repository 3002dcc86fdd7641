// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/cost_map_provider.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/server/navigation/floor_example.h"

namespace engram::navigation {
namespace {

using std::chrono::seconds;
using testing::class_of;
using testing::kBegin;
using ::testing::SizeIs;
using testing::surface_at;
using testing::thing_at;

class CostMapProviderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = Memory::open(scratch / "robot.engram");
    ASSERT_OK(opened);
    memory = *std::move(opened);
    ASSERT_OK(memory->commit(
        {{class_of("chair", "box", 0.5, 0.5, 0.9), surface_at("table", {2, 0, 0}, 0.75, 0.8, 1.4),
          thing_at("chair_1", "chair", {-2, 0, 0}, 0.45, kBegin)}}));
  }

  void move(const std::string& chair, const PlanarPose& pose, Time time) {
    ASSERT_OK(
        memory->commit({{thing_at(chair, "chair", pose, 0.45, time)}}, CommitDurability::kMemory));
    ASSERT_TRUE(provider->wait_for(testing::thing_id(chair).at(time), seconds(20)));
  }

  CostMap stored(const std::string& selector = "latest") {
    const auto found = memory->query("Navigation/CostMap/navigation/floor @ " + selector);
    ENGRAM_CHECK(found.ok(), "{}", found.status().message());
    const ltm::EntityResult* entity = found->entities().front();
    return CostMap::from_data(entity->snapshots.back().instances.front().data,
                              entity->id.at(entity->snapshots.back().time).instance(0))
        .value();
  }

  ScratchDirectory scratch;
  std::unique_ptr<Memory> memory;
  std::unique_ptr<CostMapProvider> provider;
};

TEST_F(CostMapProviderTest, CommitsAMapOfWhatIsThereAndOneOfEachMove) {
  auto started = CostMapProvider::start(*memory, {});
  ASSERT_OK(started);
  provider = *std::move(started);
  const CostMap first = stored();
  EXPECT_EQ(first.version, 1);
  EXPECT_THAT(first.obstacles, SizeIs(2));
  EXPECT_EQ(first.cost_at({-2, 0}), kLethalCost);
  EXPECT_EQ(first.cost_at({2, 0.5}), kLethalCost);
  EXPECT_EQ(first.cost_at({0, 0}), kFreeCost);

  move("chair_1", {0, 0, 0}, kBegin + seconds(1));
  const CostMap second = stored();
  EXPECT_EQ(second.version, 2);
  EXPECT_EQ(second.id.time(), kBegin + seconds(1));
  EXPECT_EQ(second.cost_at({0, 0}), kLethalCost);
  EXPECT_EQ(second.cost_at({-2, 0}), kFreeCost);
  EXPECT_EQ(second.obstacles.front().snapshot,
            testing::thing_id("chair_1").at(kBegin + seconds(1)).instance(0));
  // The map before is still there.
  EXPECT_EQ(stored("-2..-2").cost_at({-2, 0}), kLethalCost);

  // A thing that stays where it is makes no new map.
  move("chair_1", {0, 0, 0}, kBegin + seconds(2));
  EXPECT_EQ(stored().version, 2);
  EXPECT_EQ(provider->counters().maps, 2U);
  EXPECT_EQ(provider->latest().id, second.id);
}

TEST_F(CostMapProviderTest, SaysInTheMapWhatItLeavesOut) {
  ASSERT_OK(memory->commit({{thing_at("box_1", "unheard", {0, 0, 0}, 0.1, kBegin)}}));
  auto started = CostMapProvider::start(*memory, {});
  ASSERT_OK(started);
  ASSERT_THAT(stored().left_out, SizeIs(1));
  EXPECT_EQ(stored().left_out[0].snapshot, testing::thing_id("box_1").at(kBegin).instance(0));
}

TEST_F(CostMapProviderTest, SaysInTheMapWhatItLeavesOutOfWhatComesLater) {
  auto started = CostMapProvider::start(*memory, {});
  ASSERT_OK(started);
  provider = *std::move(started);
  EXPECT_THAT(stored().left_out, SizeIs(0));
  const Time time = kBegin + seconds(1);
  ASSERT_OK(memory->commit({{thing_at("box_1", "unheard", {0, 0, 0}, 0.1, time)}},
                           CommitDurability::kMemory));
  ASSERT_TRUE(provider->wait_for(testing::thing_id("box_1").at(time), seconds(20)));
  ASSERT_THAT(stored().left_out, SizeIs(1));
  EXPECT_EQ(stored().left_out[0].snapshot, testing::thing_id("box_1").at(time).instance(0));
}

TEST_F(CostMapProviderTest, WaitsForNothingThatWasThereWhenItStarted) {
  auto started = CostMapProvider::start(*memory, {});
  ASSERT_OK(started);
  for (const ltm::MemoryId& known :
       {testing::thing_id("chair_1"), testing::surface_id("table"), testing::class_id("chair")})
    EXPECT_TRUE((*started)->wait_for(known.at(kBegin), Duration())) << known.printable();
  EXPECT_FALSE((*started)->wait_for(testing::thing_id("chair_1").at(kBegin + seconds(1)),
                                    std::chrono::milliseconds(10)));
  EXPECT_FALSE((*started)->wait_for(ltm::MemoryId::parse("Speech/Commands/human/text")->at(kBegin),
                                    std::chrono::milliseconds(10)));
}

TEST_F(CostMapProviderTest, GoesOnWithVersionsAndTimesOfTheOneBefore) {
  { ASSERT_OK(CostMapProvider::start(*memory, {})); }
  auto started = CostMapProvider::start(*memory, {});
  ASSERT_OK(started);
  EXPECT_EQ(stored().version, 2);
  EXPECT_EQ(stored().id.time(), kBegin + Duration(1));
}

TEST_F(CostMapProviderTest, IsAfterManyMovesWhatAnotherProviderMakes) {
  auto started = CostMapProvider::start(*memory, {});
  ASSERT_OK(started);
  provider = *std::move(started);
  for (int i = 1; i <= 200; ++i)
    ASSERT_OK(memory->commit(
        {{thing_at("chair_" + std::to_string(i % 7), "chair",
                   {0.3 * (i % 23) - 3, 0.2 * (i % 31) - 3, 0.1 * i}, 0.45, kBegin + seconds(i))}},
        CommitDurability::kMemory));
  for (int i = 194; i <= 200; ++i)
    ASSERT_TRUE(provider->wait_for(
        testing::thing_id("chair_" + std::to_string(i % 7)).at(kBegin + seconds(i)), seconds(20)));
  const CostMap grown = provider->latest();
  MapRules rules;
  rules.map = "again";
  auto again = CostMapProvider::start(*memory, {.rules = rules});
  ASSERT_OK(again);
  EXPECT_EQ(cv::countNonZero(grown.costs != (*again)->latest().costs), 0);
  EXPECT_EQ(grown.obstacles.size(), 8U);
}

TEST_F(CostMapProviderTest, StartsInAMemoryThatHasNothing) {
  auto empty = Memory::open(scratch / "empty.engram");
  ASSERT_OK(empty);
  auto started = CostMapProvider::start(**empty, {});
  ASSERT_OK(started);
  EXPECT_EQ((*started)->latest().cost_at({0, 0}), kFreeCost);
  // Nothing is committed before anything tells what time it is.
  const auto maps = ltm::Query::parse("Navigation/CostMap @ all");
  ASSERT_OK(maps);
  EXPECT_FAILS((*empty)->query(*maps), StatusCode::kNotFound, "");
  ASSERT_OK((*empty)->commit(
      {{class_of("chair", "box", 0.5, 0.5, 0.9), thing_at("chair_1", "chair", {}, 0.45, kBegin)}}));
  ASSERT_TRUE((*started)->wait_for(testing::thing_id("chair_1").at(kBegin), seconds(20)));
  const auto first = (*empty)->query(*maps);
  ASSERT_OK(first);
  EXPECT_EQ(first->entities().front()->snapshots.front().time, kBegin);
}

TEST_F(CostMapProviderTest, RefusesRulesThatDoNotValidate) {
  MapRules rules;
  rules.frame.rows = -1;
  EXPECT_FAILS(CostMapProvider::start(*memory, {.rules = rules}), StatusCode::kInvalidArgument,
               "rows");
}

}  // namespace
}  // namespace engram::navigation
