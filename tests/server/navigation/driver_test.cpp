// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "server/navigation/locations.h"
#include "server/navigation/plan_check.h"
#include "server/navigation/why.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/server/navigation/drive_series.h"
#include "tests/server/navigation/floor_example.h"
#include "tests/server/navigation/simulated_floor.h"

namespace engram::navigation {
namespace {

using ::navigation::EventKind;
using std::chrono::seconds;
using ::testing::HasSubstr;
using testing::SimulatedFloor;

class DriverTest : public ::testing::Test {
 protected:
  void start(SimulatedFloor::Options floor_options = {.chairs = 2, .persons = 0},
             Driver::Options options = {}) {
    auto opened = Memory::open(scratch / "robot.engram");
    ASSERT_OK(opened);
    memory = *std::move(opened);
    floor = std::make_unique<SimulatedFloor>(*memory, floor_options);
    ASSERT_OK(floor->commit_first());
    auto started = CostMapProvider::start(*memory, {});
    ASSERT_OK(started);
    provider = *std::move(started);
    auto made = Driver::open(*memory, options);
    ASSERT_OK(made);
    driver = *std::move(made);
    floor->wait_for_maps(*provider, driver->maps());
  }

  std::vector<::navigation::Event> events() {
    std::vector<::navigation::Event> events;
    const auto found = memory->query("Navigation/Event/robot/drive @ all");
    for (const ltm::EntityResult* entity : found->entities())
      for (const ltm::SnapshotResult& snapshot : entity->snapshots)
        events.push_back(::navigation::Event::from_idf(snapshot.instances.front().data).value());
    return events;
  }

  ScratchDirectory scratch;
  std::unique_ptr<Memory> memory;
  std::unique_ptr<SimulatedFloor> floor;
  std::unique_ptr<CostMapProvider> provider;
  std::unique_ptr<Driver> driver;
};

TEST_F(DriverTest, ArrivesAtFurnitureAndLeavesItsEvents) {
  start();
  const auto outcome = driver->drive({.goal = "table"}, *floor);
  ASSERT_OK(outcome);
  EXPECT_TRUE(outcome->has_arrived()) << outcome->reason;
  EXPECT_EQ(floor->collisions(), 0);
  const std::vector<::navigation::Event> told = events();
  EXPECT_EQ(told.front().kind, EventKind::STARTED);
  EXPECT_EQ(told.back().kind, EventKind::ARRIVED);
  EXPECT_EQ(told.back().plan, outcome->plan);
  EXPECT_EQ(told.back().goal, "table");
  const auto plan = ::navigation::Plan::from_idf(*value_at(*memory, outcome->plan));
  ASSERT_OK(plan);
  EXPECT_NEAR(floor->state()->pose_world_robot.x_m, plan->pose_world_goal.values<double>()[0],
              0.07);
}

TEST_F(DriverTest, PlansAgainWhenAChairIsPutInItsWay) {
  start();
  bool is_put = false;
  floor->put_robot({-4, -4, 0});
  ASSERT_OK(floor->put("chair_1", {0, 0, 0}));
  ASSERT_OK(floor->put("chair_2", {0, 3, 0}));
  floor->on_step = [&] {
    if (is_put || floor->state()->pose_world_robot.x_m < -2.5) return;
    is_put = true;
    ASSERT_OK(floor->put("chair_1", {0, -4, 0}));
  };
  const auto outcome = driver->drive({.pose = {3, -4, 0}}, *floor);
  ASSERT_OK(outcome);
  EXPECT_TRUE(outcome->has_arrived()) << outcome->reason;
  EXPECT_TRUE(is_put);
  EXPECT_GE(outcome->replans, 1);
  EXPECT_EQ(floor->collisions(), 0);
}

TEST_F(DriverTest, GivesUpWhenPersonsSurroundItAndNamesThem) {
  start({.chairs = 0, .persons = 9}, {.patience = seconds(3)});
  const auto stand_around = [&] {
    const PlanarPose robot = floor->state()->pose_world_robot;
    for (int i = 0; i < 9; ++i)
      ASSERT_OK(floor->put(
          fmt::format("person_{}", i + 1),
          {robot.x_m + 1.2 * std::cos(i * 0.698), robot.y_m + 1.2 * std::sin(i * 0.698), 0}));
  };
  floor->put_robot({-2, -2.5, 0});
  stand_around();
  ASSERT_OK(floor->wait(std::chrono::milliseconds(50)));
  const auto outcome = driver->drive({.goal = "table"}, *floor);
  ASSERT_OK(outcome);
  EXPECT_EQ(outcome->kind, EventKind::TRAPPED) << outcome->reason;
  EXPECT_THAT(outcome->reason, HasSubstr("is surrounded by person_"));
  EXPECT_EQ(events().front().kind, EventKind::BLOCKED);
  EXPECT_EQ(events().back().blocked_by.size(), 9U);
  // They let it go, and stand around it again while it drives.
  for (int i = 0; i < 9; ++i)
    ASSERT_OK(floor->put(fmt::format("person_{}", i + 1), {-4.3 + i, 4, 0}));
  int steps = 0;
  floor->on_step = [&] {
    if (++steps == 40) stand_around();
  };
  const auto trapped = driver->drive({.pose = {3, -4, 0}}, *floor);
  ASSERT_OK(trapped);
  EXPECT_EQ(trapped->kind, EventKind::TRAPPED) << trapped->reason;
  EXPECT_THAT(trapped->reason, HasSubstr("person_"));
  EXPECT_FALSE(events().back().blocked_by.empty());
  EXPECT_EQ(floor->collisions(), 0);
}

TEST_F(DriverTest, StopsWhenItIsToldAndSaysSo) {
  start();
  std::stop_source stop;
  int steps = 0;
  floor->on_step = [&] {
    if (++steps == 60) stop.request_stop();
  };
  const auto outcome = driver->drive({.goal = "table"}, *floor, stop.get_token());
  ASSERT_OK(outcome);
  EXPECT_EQ(outcome->kind, EventKind::STOPPED);
  EXPECT_EQ(events().back().kind, EventKind::STOPPED);
  EXPECT_EQ(floor->state()->twist, Twist{});
  EXPECT_LT(steps, 75);
}

TEST_F(DriverTest, RefusesPlacesThatNobodyKnowsAndGoalsThatAreNotFree) {
  start();
  std::string reported;
  const auto unknown = driver->drive({.goal = "tabel"}, *floor, {},
                                     [&](EventKind, const std::string& text) { reported = text; });
  ASSERT_OK(unknown);
  EXPECT_EQ(unknown->kind, EventKind::REFUSED);
  EXPECT_THAT(unknown->reason, HasSubstr("did you mean 'table'"));
  EXPECT_EQ(reported, unknown->reason);
  const auto inside = driver->drive({.pose = {1.5, 1, 0}}, *floor);
  ASSERT_OK(inside);
  EXPECT_THAT(inside->reason, HasSubstr("too near to table"));
  EXPECT_EQ(events().back().blocked_by.size(), 1U);
  const auto infinite = driver->drive({.pose = {std::nan(""), 1, 0}}, *floor);
  ASSERT_OK(infinite);
  EXPECT_THAT(infinite->reason, HasSubstr("not finite"));
}

TEST_F(DriverTest, RefusesToDriveOnAMapThatNobodyUpdates) {
  start();
  provider.reset();
  ASSERT_OK(memory->commit(
      {{testing::thing_at("chair_1", "chair", {0, 0, 0}, 0.45, floor->now() + seconds(1))}}));
  const auto outcome = driver->drive({.goal = "table"}, *floor);
  ASSERT_OK(outcome);
  EXPECT_EQ(outcome->kind, EventKind::REFUSED);
  EXPECT_THAT(outcome->reason, HasSubstr("the map is stale"));
  EXPECT_THAT(outcome->reason, HasSubstr("chair_1"));
}

TEST_F(DriverTest, StopsWhenNobodyKeepsTheMapUpToDateAnyMore) {
  start({.chairs = 0, .persons = 0});
  int steps = 0;
  floor->on_step = [&] {
    if (++steps != 20) return;
    floor->wait_for_no_maps();
    provider.reset();
    ASSERT_OK(
        memory->commit({{testing::thing_at("chair_9", "chair", {4, -4, 0}, 0.45, floor->now())}}));
  };
  const auto outcome = driver->drive({.goal = "table"}, *floor);
  ASSERT_OK(outcome);
  EXPECT_EQ(outcome->kind, EventKind::FAILED);
  EXPECT_THAT(outcome->reason, HasSubstr("nobody keeps the map up to date"));
  EXPECT_THAT(outcome->reason, HasSubstr("chair_9' came"));
  EXPECT_LT(steps, 60);
}

/// The platform fails; the drive must not leave it moving.
class BrokenBase : public DriveBase {
 public:
  Result<BaseState> state() override {
    if (++states_ > 5) return unavailable("the platform does not answer");
    return BaseState{testing::kBegin + seconds(states_), {-3, -3, 0}, {}};
  }
  Status move(const Twist&) override { return {}; }
  Status stop() override {
    is_stopped = true;
    return {};
  }
  Status wait(Duration) override { return {}; }

  bool is_stopped = false;

 private:
  int states_ = 0;
};

TEST_F(DriverTest, StopsABaseThatFails) {
  start();
  BrokenBase base;
  EXPECT_FAILS(driver->drive({.goal = "table"}, base), StatusCode::kUnavailable, "does not answer");
  EXPECT_TRUE(base.is_stopped);
}

// `make drives` makes 500 of them.
TEST(Drives, AmongChairsAndPersonsTouchNothingAndAreAllExplained) {
  const ScratchDirectory scratch;
  const auto series = testing::drive_series(scratch / "robot.engram", {.drives = 15, .seed = 1});
  ASSERT_OK(series);
  EXPECT_EQ(series->drives, 15);
  EXPECT_EQ(series->collisions, 0) << series->first_collision;
  EXPECT_EQ(series->without_reason, 0);
  EXPECT_EQ(series->explained, 15);
  EXPECT_GE(series->arrived, 8);
}

}  // namespace
}  // namespace engram::navigation
