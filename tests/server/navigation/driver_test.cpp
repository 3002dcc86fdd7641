// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>

#include "server/navigation/locations.h"
#include "server/navigation/plan_check.h"
#include "server/navigation/why.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/server/navigation/drive_series.h"
#include "tests/server/navigation/floor_example.h"
#include "tests/server/navigation/hooked_memory.h"
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
    memory = std::make_unique<testing::HookedMemory>(*std::move(opened));
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
  std::unique_ptr<testing::HookedMemory> memory;
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
  const auto outcome = driver->drive({.pose = PlanarPose{3, -4, 0}}, *floor);
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
  const auto trapped = driver->drive({.pose = PlanarPose{3, -4, 0}}, *floor);
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
  const auto inside = driver->drive({.pose = PlanarPose{1.5, 1, 0}}, *floor);
  ASSERT_OK(inside);
  EXPECT_THAT(inside->reason, HasSubstr("too near to table"));
  EXPECT_EQ(events().back().blocked_by.size(), 1U);
  const auto infinite = driver->drive({.pose = PlanarPose{std::nan(""), 1, 0}}, *floor);
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

/// How far the robot really is from the outline of a thing.
double distance_of(SimulatedFloor& floor, const std::string& name) {
  return floor.body(name)->distance_m(floor.state()->pose_world_robot.position());
}

TEST_F(DriverTest, GoesToWhereItsGoalWasPushedTo) {
  start();
  floor->put_robot({-4, -4, 0});
  ASSERT_OK(floor->put("chair_1", {3, -4, 0}));
  ASSERT_OK(floor->put("chair_2", {-4, 3, 0}));
  ASSERT_OK(floor->wait(std::chrono::milliseconds(50)));
  bool is_pushed = false;
  floor->on_step = [&] {
    if (is_pushed || floor->state()->pose_world_robot.x_m < 0) return;
    is_pushed = true;
    ASSERT_OK(floor->put("chair_1", {-1, 3, 0}));
  };
  // The other chair is nearer by then, but it was not what the robot went to.
  const auto outcome = driver->drive({.goal = "chair"}, *floor);
  ASSERT_OK(outcome);
  EXPECT_TRUE(outcome->has_arrived()) << outcome->reason;
  EXPECT_TRUE(is_pushed);
  EXPECT_LT(distance_of(*floor, "chair_1"), 0.75);
  EXPECT_EQ(floor->collisions(), 0);
}

TEST_F(DriverTest, LooksForItsGoalAgainBeforeItSaysThatItArrived) {
  start();
  floor->put_robot({-4, -4, 0});
  ASSERT_OK(floor->put("chair_1", {0, -4, 0}));
  ASSERT_OK(floor->wait(std::chrono::milliseconds(50)));
  int pushes = 0;
  // It is taken away when the robot is there already and only turns any more.
  floor->on_step = [&] {
    if (pushes > 0 || distance_of(*floor, "chair_1") > 0.66) return;
    ++pushes;
    ASSERT_OK(floor->put("chair_1", {0, -1, 0}));
  };
  const auto outcome = driver->drive({.goal = "chair_1"}, *floor);
  ASSERT_OK(outcome);
  EXPECT_TRUE(outcome->has_arrived()) << outcome->reason;
  EXPECT_EQ(pushes, 1);
  EXPECT_LT(distance_of(*floor, "chair_1"), 0.75);
  EXPECT_GE(outcome->replans, 1);
}

TEST_F(DriverTest, GoesToWhereALocationWasMovedByLittle) {
  start({.chairs = 0, .persons = 0});
  const auto commit_at = [&](double x_m) {
    ::navigation::Location post;
    post.name = "post";
    post.pose_world_location = PlanarPose{x_m, -4, 0}.to_array();
    return commit_location(*memory, "test", post, floor->now());
  };
  ASSERT_OK(commit_at(0));
  floor->put_robot({-4, -4, 0});
  bool is_moved = false;
  // Nothing on the floor moves, so no map tells of it.
  floor->on_step = [&] {
    if (is_moved || floor->state()->pose_world_robot.x_m < -2) return;
    is_moved = true;
    ASSERT_OK(commit_at(0.25));
  };
  const auto outcome = driver->drive({.goal = "post"}, *floor);
  ASSERT_OK(outcome);
  EXPECT_TRUE(outcome->has_arrived()) << outcome->reason;
  EXPECT_TRUE(is_moved);
  EXPECT_NEAR(floor->state()->pose_world_robot.x_m, 0.25, 0.07);
}

TEST_F(DriverTest, RefusesARequestThatNamesNoPlace) {
  start();
  const PlanarPose before = floor->state()->pose_world_robot;
  const auto outcome = driver->drive({}, *floor);
  ASSERT_OK(outcome);
  EXPECT_EQ(outcome->kind, EventKind::REFUSED);
  EXPECT_EQ(outcome->reason, "the request names no place");
  EXPECT_EQ(floor->state()->pose_world_robot, before);
}

TEST_F(DriverTest, RefusesASecondDriveAndDoesNotDisturbTheFirst) {
  start();
  int refused = 0;
  floor->on_step = [&] {
    if (++refused > 2) return;
    EXPECT_FAILS(driver->drive({.goal = "sofa"}, *floor), StatusCode::kFailedPrecondition,
                 "'robot' drives or plans already");
    EXPECT_FAILS(driver->plan({.goal = "sofa"}, {}, floor->now()), StatusCode::kFailedPrecondition,
                 "drives or plans already");
  };
  const auto outcome = driver->drive({.goal = "table"}, *floor);
  ASSERT_OK(outcome);
  EXPECT_TRUE(outcome->has_arrived()) << outcome->reason;
  EXPECT_GT(refused, 2);
  EXPECT_OK(driver->plan({.goal = "sofa"}, {}, floor->now()));
}

TEST_F(DriverTest, HasAllItsPatienceAgainAfterNoWayLedOn) {
  start({.chairs = 0, .persons = 9}, {.patience = seconds(3)});
  floor->put_robot({-2, -2.5, 0});
  for (int i = 0; i < 9; ++i)
    ASSERT_OK(floor->put(fmt::format("person_{}", i + 1),
                         {-2 + 1.2 * std::cos(i * 0.698), -2.5 + 1.2 * std::sin(i * 0.698), 0}));
  ASSERT_OK(floor->wait(std::chrono::milliseconds(50)));
  int steps = 0;
  floor->on_step = [&] {
    // 2.9 s of 3 s.
    if (++steps != 58) return;
    for (int i = 0; i < 9; ++i)
      ASSERT_OK(floor->put(fmt::format("person_{}", i + 1), {-4.3 + i, 4, 0}));
  };
  const auto outcome = driver->drive({.goal = "table"}, *floor);
  ASSERT_OK(outcome);
  EXPECT_EQ(events().front().kind, EventKind::BLOCKED);
  EXPECT_TRUE(outcome->has_arrived()) << outcome->reason;
}

TEST_F(DriverTest, PassesOnThatTheMemoryFailed) {
  start();
  memory->on_query = [this]() -> Status {
    return floor->now() > testing::kBegin + seconds(2) ? unavailable("the server is away")
                                                       : Status();
  };
  // Not that nobody knows the table.
  EXPECT_FAILS(driver->drive({.goal = "table"}, *floor), StatusCode::kUnavailable,
               "the server is away");
  ASSERT_OK(floor->wait(seconds(2)));
  EXPECT_EQ(floor->state()->twist, Twist{});
  EXPECT_FAILS(driver->plan({.goal = "table"}, {}, floor->now()), StatusCode::kUnavailable,
               "the server is away");
}

/// Counts how often the platform was told to stop.
class CountedStops : public DriveBase {
 public:
  explicit CountedStops(DriveBase& inner) : inner_(inner) {}
  Result<BaseState> state() override { return inner_.state(); }
  Status move(const Twist& twist) override { return inner_.move(twist); }
  Status stop() override {
    ++stops;
    return inner_.stop();
  }
  Status wait(Duration time) override { return inner_.wait(time); }

  std::atomic<int> stops = 0;

 private:
  DriveBase& inner_;
};

TEST_F(DriverTest, StopsWhileTheMemoryDoesNotAnswer) {
  start();
  CountedStops base(*floor);
  std::atomic<int> slow = 0;
  std::atomic<int> left_alone = 0;
  // Answers come only after the robot was told to stop. Who never tells it waits for all of this.
  memory->on_query = [&]() -> Status {
    if (floor->now() < testing::kBegin + seconds(2) || slow >= 4) return {};
    ++slow;
    const int before = base.stops;
    for (int i = 0; i < 2000 && base.stops == before; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    left_alone += base.stops == before ? 1 : 0;
    return {};
  };
  const auto outcome = driver->drive({.pose = PlanarPose{3, -4, 0}}, base);
  ASSERT_OK(outcome);
  EXPECT_EQ(slow, 4);
  EXPECT_EQ(left_alone, 0);
  EXPECT_TRUE(outcome->has_arrived()) << outcome->reason;
}

TEST_F(DriverTest, RestsBeforeItReturnsThoughItsPlatformHearsLate) {
  Driver::Options options;
  options.limits.reaction_s = 0.25;
  start({.chairs = 0, .persons = 0, .latency = std::chrono::milliseconds(100)}, options);
  std::stop_source stop;
  int steps = 0;
  // The first command to move was given, and is not heard yet.
  floor->on_step = [&] {
    if (++steps == 1) stop.request_stop();
  };
  floor->put_robot({-4, -4, 0});
  const auto outcome = driver->drive({.pose = PlanarPose{3, -4, 0}}, *floor, stop.get_token());
  ASSERT_OK(outcome);
  EXPECT_EQ(outcome->kind, EventKind::STOPPED);
  const PlanarPose rested = floor->state()->pose_world_robot;
  ASSERT_OK(floor->wait(seconds(1)));
  EXPECT_NEAR((floor->state()->pose_world_robot.position() - rested.position()).norm(), 0, 0.002);
}

// `make drives` makes 500 of them.
TEST(Drives, AmongChairsAndPersonsTouchNothingAndAreAllExplained) {
  const ScratchDirectory scratch;
  const auto series = testing::drive_series(scratch / "robot.engram", {.drives = 15, .seed = 1});
  ASSERT_OK(series);
  EXPECT_EQ(series->drives, 15);
  EXPECT_EQ(series->collisions, 0) << series->first_collision;
  EXPECT_EQ(series->without_reason, 0);
  EXPECT_EQ(series->elsewhere, 0) << series->max_beside_m;
  EXPECT_EQ(series->explained, 15);
  EXPECT_GE(series->arrived, 8);
}

}  // namespace
}  // namespace engram::navigation
