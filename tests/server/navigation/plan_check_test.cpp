// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/plan_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ltm/memory/links.h"
#include "server/navigation/cost_map_provider.h"
#include "server/navigation/driver.h"
#include "server/navigation/locations.h"
#include "server/navigation/why.h"
#include "server/skills/skill_records.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"
#include "tests/server/navigation/floor_example.h"

namespace engram::navigation {
namespace {

using std::chrono::seconds;
using testing::class_of;
using ::testing::HasSubstr;
using testing::kBegin;
using ::testing::SizeIs;
using testing::surface_at;
using testing::thing_at;

class PlanCheck : public ::testing::Test {
 protected:
  void SetUp() override {
    auto opened = Memory::open(scratch / "robot.engram");
    ASSERT_OK(opened);
    memory = *std::move(opened);
    commit({class_of("chair", "box", 0.5, 0.5, 0.9), surface_at("table", {2, 0, 0}, 0.75, 0.8, 1.4),
            class_of("salt", "cylinder", 0.05, 0.05, 0.1),
            thing_at("salt_1", "salt", {2, 0.5, 0}, 0.8, kBegin),
            thing_at("chair_1", "chair", {-2, 0, 0}, 0.45, kBegin)});
    auto started = CostMapProvider::start(*memory, {});
    ASSERT_OK(started);
    provider = *std::move(started);
    auto made = Driver::open(*memory, {});
    ASSERT_OK(made);
    driver = *std::move(made);
  }

  void commit(std::vector<ltm::Snapshot> snapshots) {
    ASSERT_OK(memory->commit({std::move(snapshots)}, CommitDurability::kMemory));
  }

  ::navigation::Plan planned(const DriveRequest& request, Time time = kBegin) {
    const auto id = driver->plan(request, {-4, -4, 0}, time);
    ENGRAM_CHECK(id.ok(), "{}", id.status().message());
    last_plan = *id;
    return ::navigation::Plan::from_idf(value_at(*memory, *id).value()).value();
  }

  ScratchDirectory scratch;
  std::unique_ptr<Memory> memory;
  std::unique_ptr<CostMapProvider> provider;
  std::unique_ptr<Driver> driver;
  ltm::MemoryId last_plan;
};

TEST_F(PlanCheck, APlanNamesItsInputsAtTheirVersions) {
  const ::navigation::Plan plan = planned({.goal = "table"});
  EXPECT_EQ(plan.state, ::navigation::PlanState::PLANNED) << plan.reason;
  EXPECT_EQ(plan.cost_map, provider->latest().id);
  EXPECT_THAT(plan.objects, SizeIs(2));
  EXPECT_EQ(plan.objects[0], testing::thing_id("chair_1").at(kBegin).instance(0));
  EXPECT_EQ(plan.location, testing::surface_id("table").at(kBegin).instance(0));
  for (const ltm::Link& link : ltm::find_links(plan.to_idf(), ::navigation::Plan::idf_type()))
    EXPECT_OK(value_at(*memory, link.id));
  EXPECT_OK(check_plan(*memory, plan, {}));
  // It stands before the table, which it faces.
  EXPECT_LT(plan.pose_world_goal.values<double>()[0], 1.6);
  EXPECT_NEAR(plan.pose_world_goal.values<double>()[2], 0, 1e-9);
}

TEST_F(PlanCheck, RefusesAPlanWhoseObjectWasMovedAndNamesBothTimes) {
  const ::navigation::Plan plan = planned({.pose = PlanarPose{4, 4, 0}});
  commit({thing_at("chair_1", "chair", {-2, 0, 0}, 0.45, kBegin + seconds(5))});
  // Seen again where it was.
  EXPECT_OK(check_plan(*memory, plan, {}));
  commit({thing_at("chair_1", "chair", {-2, 1, 0}, 0.45, kBegin + seconds(10))});
  const Status refused = check_plan(*memory, plan, {});
  EXPECT_EQ(refused.code(), StatusCode::kFailedPrecondition);
  EXPECT_THAT(refused.message(),
              HasSubstr("'Objects/Instances/kitchen/chair_1' was moved: the map knows it as of "
                        "2023-11-14 22:13:20.000000, the memory as of 2023-11-14 22:13:30.000000"));
}

TEST_F(PlanCheck, RefusesAPlanWhenAnObjectCameOrWent) {
  ::navigation::Plan plan = planned({.pose = PlanarPose{4, 4, 0}});
  commit({thing_at("chair_2", "chair", {0, 0, 0}, 0.45, kBegin + seconds(1))});
  EXPECT_FAILS(check_plan(*memory, plan, {}), StatusCode::kFailedPrecondition, "chair_2' came");
  ASSERT_TRUE(
      provider->wait_for(testing::thing_id("chair_2").at(kBegin + seconds(1)), seconds(20)));
  ASSERT_TRUE(driver->maps().wait_for(*provider->latest().id.time(), seconds(20)));
  plan = planned({.pose = PlanarPose{4, 4, 0}}, kBegin + seconds(2));
  EXPECT_OK(check_plan(*memory, plan, {}));
  commit({thing_at("chair_2", "chair", {0, 0, 0}, 1.2, kBegin + seconds(3), "left")});
  EXPECT_FAILS(check_plan(*memory, plan, {}), StatusCode::kFailedPrecondition,
               "chair_2' is no longer in the way");
}

TEST_F(PlanCheck, RefusesAPlanOnAMapThatNobodyUpdates) {
  provider.reset();
  commit({thing_at("chair_1", "chair", {1, 1, 0}, 0.45, kBegin + seconds(1))});
  const ::navigation::Plan plan = planned({.pose = PlanarPose{4, 4, 0}}, kBegin + seconds(2));
  EXPECT_EQ(plan.state, ::navigation::PlanState::REFUSED);
  EXPECT_THAT(plan.reason, HasSubstr("the map is stale: 'Objects/Instances/kitchen/chair_1'"));
  EXPECT_FAILS(check_plan(*memory, plan, {}), StatusCode::kFailedPrecondition, "has no way");
}

TEST_F(PlanCheck, FindsGoalsByNameAliasNumberAndWhatStandsOnFurniture) {
  ::navigation::Location dock;
  dock.name = "dock";
  dock.aliases = {"charging station", "home"};
  dock.pose_world_location = PlanarPose{-4, 4, 1}.to_array();
  ASSERT_OK(commit_location(*memory, "people", dock, kBegin));
  ::navigation::Location seat;
  seat.name = "my seat";
  seat.object = testing::thing_id("chair_1");
  seat.pose_object_location = PlanarPose{-1, 0, 0}.to_array();
  ASSERT_OK(commit_location(*memory, "people", seat, kBegin));
  const CostMap map = provider->latest();
  for (const char* name : {"dock", "Charging_Station", "HOME"}) {
    const auto goal = find_goal(*memory, MapRules{}, name, map, {});
    ASSERT_OK(goal);
    EXPECT_EQ(goal->poses.front(), (PlanarPose{-4, 4, 1}));
    EXPECT_EQ(goal->location, location_entity("people", "dock")->at(kBegin).instance(0));
  }
  const auto beside_chair = find_goal(*memory, MapRules{}, "my seat", map, {});
  ASSERT_OK(beside_chair);
  EXPECT_EQ(beside_chair->poses.front(), (PlanarPose{-3, 0, 0}));
  EXPECT_EQ(find_goal(*memory, MapRules{}, "chair", map, {})->name, "chair_1");
  const auto salt = find_goal(*memory, MapRules{}, "salt", map, {});
  ASSERT_OK(salt);
  EXPECT_EQ(salt->name, "salt_1");
  EXPECT_LT(salt->poses.front().x_m, 1.6);
}

TEST_F(PlanCheck, NamesTheClosestPlacesWhereOneIsUnknown) {
  const auto goal = find_goal(*memory, MapRules{}, "tabel", provider->latest(), {});
  EXPECT_FAILS(goal, StatusCode::kNotFound, "did you mean 'table'");
  EXPECT_THAT(goal.status().message(), HasSubstr("chair 1"));
  const ::navigation::Plan plan = planned({.goal = "tabel"});
  EXPECT_THAT(plan.reason, HasSubstr("did you mean 'table'"));
}

TEST_F(PlanCheck, GoesToOtherPlacesAlthoughALocationIsMalformed) {
  commit({{location_entity("people", "dock").value(), kBegin, {{idf::Dict{{"name", 3}}, {}}}}});
  const auto table = find_goal(*memory, MapRules{}, "table", provider->latest(), {});
  ASSERT_OK(table);
  EXPECT_EQ(table->name, "table");
  EXPECT_FAILS(find_goal(*memory, MapRules{}, "dock", provider->latest(), {}),
               StatusCode::kNotFound, "unknown");
}

TEST_F(PlanCheck, FindsThingsWhereTheRulesOfTheMapSay) {
  const ltm::MemoryId jar = ltm::MemoryId::parse("Store/Goods/shop/jar").value();
  commit({{jar, kBegin, {{idf::Dict{{"place", testing::pose_data({2, 0.5, 0}, 0.8)}}, {}}}}});
  MapRules rules;
  rules.sources.push_back({.names = "Store/Goods/.*/.*", .pose_member = "place"});
  const CostMap map = provider->latest();
  const auto found = find_goal(*memory, rules, "jar", map, {});
  ASSERT_OK(found);
  EXPECT_EQ(found->location, jar.at(kBegin).instance(0));
  EXPECT_FAILS(find_goal(*memory, MapRules{}, "jar", map, {}), StatusCode::kNotFound, "jar");
  // What the rules do not name is no goal either.
  rules.sources = {MapRules::surfaces()};
  EXPECT_FAILS(find_goal(*memory, rules, "salt", map, {}), StatusCode::kNotFound, "salt");
}

TEST_F(PlanCheck, RefusesLocationsThatAreNowhere) {
  ::navigation::Location nowhere;
  nowhere.name = "nowhere";
  EXPECT_FAILS(commit_location(*memory, "people", nowhere, kBegin), StatusCode::kInvalidArgument,
               "needs a pose_world_location");
  nowhere.pose_world_location = PlanarPose{std::nan(""), 0, 0}.to_array();
  EXPECT_FAILS(commit_location(*memory, "people", nowhere, kBegin), StatusCode::kInvalidArgument,
               "finite");
}

TEST_F(PlanCheck, WhyFollowsLinksToTheWordsThatWereSaid) {
  const ltm::MemoryId speech =
      ltm::MemoryId::parse("Speech/Commands/human/text")->at(kBegin).instance(0);
  commit({{speech.entity(), kBegin, {{idf::Dict{{"text", "Go to the table!"}}, {}}}}});
  // As the memory of skills writes it.
  for (const auto& [segment, type] : skills::skill_types())
    ASSERT_OK(memory->declare(segment, type));
  skills::SkillRecords records(
      *memory, [] { return kBegin; }, CommitDurability::kMemory);
  ::skill::ExecutionRequest asked;
  asked.skill = "robot/drive";
  // A cause that names no snapshot leads nowhere.
  asked.causes = {speech.entity(), speech};
  const auto request = records.add_request("human", {"robot", "drive"}, asked);
  ASSERT_OK(request);
  planned({.goal = "table", .request = *request});
  const auto steps = why(*memory, last_plan);
  ASSERT_OK(steps);
  ASSERT_THAT(*steps, SizeIs(3));
  EXPECT_EQ((*steps)[0].id, last_plan);
  EXPECT_EQ((*steps)[1].id, *request);
  EXPECT_EQ((*steps)[1].member, "request");
  EXPECT_EQ((*steps)[1].says, "robot/drive");
  EXPECT_EQ((*steps)[2].id, speech);
  EXPECT_EQ((*steps)[2].says, "Go to the table!");
  EXPECT_THAT(why_text(*steps), HasSubstr("because of its causes: Speech/Commands/human/text"));
  // A request without causes, or one that was forgotten, does not hide that of the plan.
  asked.causes.clear();
  const auto causeless = records.add_request("human", {"robot", "drive"}, asked);
  ASSERT_OK(causeless);
  for (const ltm::MemoryId& asked_by : {*causeless, request->entity().at(kBegin + seconds(5))}) {
    planned({.goal = "table", .request = asked_by, .cause = speech}, kBegin + seconds(1));
    const auto beside = why(*memory, last_plan);
    ASSERT_OK(beside);
    ASSERT_THAT(*beside, SizeIs(3));
    EXPECT_EQ((*beside)[2].id, speech);
    EXPECT_EQ((*beside)[2].member, "cause");
  }
  EXPECT_FAILS(why(*memory, speech.entity().at(kBegin + seconds(9))), StatusCode::kNotFound, "");
}

TEST_F(PlanCheck, WhyEndsWhereLinksLeadInCirclesOrToNothing) {
  const ltm::MemoryId a = ltm::MemoryId::parse("A/B/C/a")->at(kBegin).instance(0);
  const ltm::MemoryId b = ltm::MemoryId::parse("A/B/C/b")->at(kBegin).instance(0);
  const ltm::MemoryId gone = ltm::MemoryId::parse("A/B/C/gone")->at(kBegin).instance(0);
  commit({{a.entity(), kBegin, {{idf::Dict{{"cause", b.to_data()}}, {}}}},
          {b.entity(), kBegin, {{idf::Dict{{"cause", a.to_data()}}, {}}}}});
  EXPECT_THAT(*why(*memory, a), SizeIs(2));
  commit({{b.entity(), kBegin + seconds(1), {{idf::Dict{{"cause", gone.to_data()}}, {}}}}});
  const auto steps = why(*memory, b.entity().at(kBegin + seconds(1)));
  ASSERT_OK(steps);
  ASSERT_THAT(*steps, SizeIs(2));
  EXPECT_EQ((*steps)[1].id, gone);
  EXPECT_THAT((*steps)[1].says, HasSubstr("no more"));
}

}  // namespace
}  // namespace engram::navigation
