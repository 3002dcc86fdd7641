// SPDX-License-Identifier: Apache-2.0
#include "server/behavior_tree/skill_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/behavior_tree/register_skills.h"
#include "tests/server/skills/skill_robot.h"

namespace engram::behavior_tree {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::PlainProvider;
using testing::SkillRobot;

constexpr const char* kWave =
    "name: wave\nparameters: {times: {type: int, default: 3, max: 10}, name: {type: string, "
    "default: '7'}}\nresources: [arm]";

class SkillNodeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    arm->come("arm", {kWave});
    ASSERT_OK(arm->welcomed());
    auto registered = register_skills(factory, *robot.memory, {.causes = {*cause}});
    ASSERT_OK(registered);
    nodes = *std::move(registered);
  }

  /// A tree of one node, or of what is given.
  BT::Tree tree(const std::string& xml) {
    return factory.createTreeFromText(R"(<root BTCPP_format="4" main_tree_to_execute="main">)"
                                      R"(<BehaviorTree ID="main">)" +
                                      xml + "</BehaviorTree></root>");
  }
  /// Ticks until it has ended.
  static BT::NodeStatus end_of(BT::Tree& tree) {
    BT::NodeStatus status = BT::NodeStatus::RUNNING;
    for (int i = 0; i < 2000 && status == BT::NodeStatus::RUNNING; ++i) {
      status = tick(tree);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return status;
  }
  static BT::NodeStatus tick(BT::Tree& tree) {
#if ENGRAM_BEHAVIOR_TREE_WAKES
    return tree.tickExactlyOnce();
#else
    return tree.tickRoot();
#endif
  }
  static std::string text_of(BT::Tree& tree, const std::string& key) {
    return tree.rootBlackboard()->get<std::string>(key);
  }

  SkillRobot robot;
  std::shared_ptr<PlainProvider> arm = PlainProvider::create(*robot.skills);
  Result<ltm::MemoryId> cause = ltm::MemoryId::parse("Tasks/Plans/planner/dishes");
  BT::BehaviorTreeFactory factory;
  std::vector<std::string> nodes;
};

TEST_F(SkillNodeTest, AnExecutionIsALeaf) {
  EXPECT_THAT(nodes, ElementsAre("Skill", "arm_wave"));
  BT::Tree one = tree(
      R"(<arm_wave times="2" name_="7" skill_reason="{reason}" skill_result="{result}" skill_end="{end}"/>)");
  EXPECT_EQ(tick(one), BT::NodeStatus::RUNNING);
  const skills::SkillStart start = arm->started();
  // "7" is a text where the parameter is one, and a number where it is a number.
  EXPECT_EQ(start.parameters_json, R"({"times":2,"name":"7"})");
  arm->end(start.execution, skills::SkillOutcome::kSuccess, "waved");
  EXPECT_EQ(end_of(one), BT::NodeStatus::SUCCESS);
  EXPECT_EQ(text_of(one, "reason"), "waved");
  EXPECT_EQ(text_of(one, "result"), "{}");
  EXPECT_THAT(text_of(one, "end"), HasSubstr("Skill/Event/arm/wave/"));

  const auto requests = robot.all<::skill::ExecutionRequest>("ExecutionRequest");
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_THAT(requests[0].causes, ElementsAre(*cause));
}

TEST_F(SkillNodeTest, FailuresAndRefusalsAreFailures) {
  BT::Tree one = tree(R"(<arm_wave skill_reason="{reason}"/>)");
  EXPECT_EQ(tick(one), BT::NodeStatus::RUNNING);
  arm->end(arm->started().execution, skills::SkillOutcome::kFailure, "the hand is off");
  EXPECT_EQ(end_of(one), BT::NodeStatus::FAILURE);
  EXPECT_EQ(text_of(one, "reason"), "the hand is off");

  BT::Tree much = tree(R"(<arm_wave times="11" skill_reason="{reason}"/>)");
  EXPECT_EQ(end_of(much), BT::NodeStatus::FAILURE);
  EXPECT_THAT(text_of(much, "reason"), HasSubstr("refused: parameters: 'times'"));
  EXPECT_EQ(arm->starts(), 1U);
}

TEST_F(SkillNodeTest, AHaltStopsTheExecutionAndWaits) {
  BT::Tree one = tree("<arm_wave/>");
  EXPECT_EQ(tick(one), BT::NodeStatus::RUNNING);
  const skills::SkillStart start = arm->started();
  std::jthread hand([&] {
    EXPECT_EQ(arm->told_to_stop().first, start.execution);
    arm->end(start.execution, skills::SkillOutcome::kStop, "at rest");
  });
  one.haltTree();
  const auto events = robot.all<::skill::Event>("Event");
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back().outcome, ::skill::Outcome::STOP);

  // It can run again.
  EXPECT_EQ(tick(one), BT::NodeStatus::RUNNING);
  arm->end(arm->started(1).execution);
  EXPECT_EQ(end_of(one), BT::NodeStatus::SUCCESS);
}

TEST_F(SkillNodeTest, ATreeThatGoesAwayStopsWhatRuns) {
  {
    BT::Tree one = tree("<arm_wave/>");
    EXPECT_EQ(tick(one), BT::NodeStatus::RUNNING);
    const skills::SkillStart start = arm->started();
    arm->end(start.execution, skills::SkillOutcome::kStop);
  }
  EXPECT_EQ(robot.all<::skill::Event>("Event").back().outcome, ::skill::Outcome::STOP);
}

TEST_F(SkillNodeTest, AFallbackTakesTheNextSkill) {
  BT::Tree two = tree(
      R"(<Fallback><Skill skill="leg/kick"/><Skill skill="arm/wave" parameters=" times=1; name=x"/></Fallback>)");
  EXPECT_EQ(tick(two), BT::NodeStatus::RUNNING);
  std::jthread hand([&] { arm->end(arm->started().execution); });
  EXPECT_EQ(end_of(two), BT::NodeStatus::SUCCESS);
  const auto refusals = robot.all<::skill::Refusal>("Refusal");
  ASSERT_EQ(refusals.size(), 1U);
  EXPECT_THAT(refusals[0].reason, HasSubstr("leg/kick"));
}

TEST_F(SkillNodeTest, PortsThatCannotBeReadAreNamed) {
  const auto error_of = [&](const std::string& xml) -> std::string {
    try {
      BT::Tree one = tree(xml);
      tick(one);
      return "none";
    } catch (const BT::RuntimeError& error) {
      return error.what();
    }
  };
  EXPECT_THAT(error_of(R"(<Skill skill="arm/wave" parameters="2"/>)"), HasSubstr("NAME=VALUE"));
  EXPECT_THAT(error_of("<Skill/>"), HasSubstr("port 'skill' is not set"));
  EXPECT_THAT(error_of(R"(<arm_wave skill_wait="soon"/>)"), HasSubstr("port 'skill_wait'"));
  EXPECT_THAT(error_of(R"(<arm_wave skill_causes="a//b"/>)"), HasSubstr("port 'skill_causes'"));
  EXPECT_THAT(error_of(R"(<arm_wave times="{missing}"/>)"), HasSubstr("port 'times'"));
  EXPECT_EQ(arm->starts(), 0U);
}

TEST_F(SkillNodeTest, ASecondRegistrationIsRefused) {
  const auto again = register_skills(factory, *robot.memory);
  ASSERT_FALSE(again.ok());
  EXPECT_EQ(again.status().code(), StatusCode::kAlreadyExists);
}

}  // namespace
}  // namespace engram::behavior_tree
