// SPDX-License-Identifier: Apache-2.0
#include "ltm/reflection/action_log.h"

#include <gmock/gmock.h>

#include "tests/ltm/reflection/example_arm.h"

namespace engram::ltm {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Actions of a robot, one after the other, each of 2 s.
class Actions {
 public:
  void run(const std::string& skill, const std::string& outcome, const std::string& object = "cup",
           const std::string& hand = "left") {
    const Time started = now_;
    add(skill, started, started, "running", object, hand);
    now_ += std::chrono::seconds(2);
    if (!outcome.empty()) add(skill, now_, started, outcome, object, hand);
    now_ += std::chrono::seconds(1);
  }

  Reflection reflect() {
    Reflection reflection;
    FindingList findings;
    log_.reflect(now_, reflection, {}, findings);
    reflection.findings = findings.take(reflection.untold);
    return reflection;
  }

 private:
  void add(const std::string& skill, Time time, Time started, const std::string& outcome,
           const std::string& object, const std::string& hand) {
    const idf::Data value = idf::Dict{{"skill", skill},
                                      {"outcome", outcome},
                                      {"started", to_ns(started)},
                                      {"object_before", "Objects/Instances/k/" + object},
                                      {"hand", hand}};
    EXPECT_TRUE(log_.add(ExampleArm::id("Skills/Actions/robot/" + skill), time, value, {}));
  }

  ActionLog log_;
  Time now_ = ExampleArm::arm_time(0);
};

TEST(ActionLog, FindsObjectAndHandInTheParametersOfASkill) {
  ActionLog log;
  const Time at = ExampleArm::arm_time(0);
  const idf::Data value = idf::Dict{
      {"skill", "arm/pick"},
      {"outcome", "success"},
      {"started", to_ns(at)},
      {"parameters", R"({"object":"Objects/Instances/k/cup_1","hand":"left","surface":"shelf"})"}};
  EXPECT_TRUE(log.add(ExampleArm::id("Skill/Event/arm/pick"), at, value, {}));
  Reflection found;
  FindingList findings;
  log.reflect(at, found, {}, findings);
  ASSERT_EQ(found.skills.size(), 1U);
  std::map<std::string, std::string> by;
  for (const SuccessRate& rate : found.skills[0].rates) by[rate.by] = rate.name;
  EXPECT_EQ(by["object"], "cup_1");
  EXPECT_EQ(by["hand"], "left");
  EXPECT_EQ(by["place"], "shelf");
}

TEST(ActionLog, CountsSuccessByObjectAndHand) {
  Actions actions;
  for (int i = 0; i < 8; ++i) actions.run("pick", "success");
  actions.run("pick", "failure", "bowl", "right");
  actions.run("pick", "stopped", "bowl", "left");
  const Reflection found = actions.reflect();
  EXPECT_EQ(found.findings.size(), 0u);
  ASSERT_EQ(found.skills.size(), 1u);
  const SuccessRate& all = found.skills[0].rates[0];
  EXPECT_EQ(all.by, "all");
  EXPECT_EQ(all.runs, 10u);
  EXPECT_EQ(all.successes, 8u);
  EXPECT_EQ(all.failures, 1u);
  EXPECT_EQ(all.stops, 1u);
  EXPECT_NEAR(all.low, 0.49, 0.01);
  EXPECT_NEAR(all.high, 0.943, 0.01);
  EXPECT_DOUBLE_EQ(all.mean_duration_s, 2);
  const SuccessRate& bowl = found.skills[0].rates[1];
  EXPECT_EQ(bowl.name, "bowl");
  EXPECT_EQ(bowl.successes, 0u);
  EXPECT_EQ(bowl.runs, 2u);
}

TEST(ActionLog, TellsWhatFollowsAFailure) {
  Actions actions;
  for (int i = 0; i < 3; ++i) {
    actions.run("pick", "failure");
    actions.run("drive", "success");
    actions.run("pick", "success");
  }
  actions.run("place", "stopped");
  actions.run("place", "success");
  const Reflection found = actions.reflect();
  ASSERT_EQ(found.chains.size(), 2u);
  EXPECT_EQ(found.chains[0].count, 3u);
  EXPECT_THAT(found.chains[0].steps, ElementsAre("pick failure", "drive success", "pick success"));
  EXPECT_THAT(found.chains[1].steps, ElementsAre("place stop", "place success"));
}

TEST(ActionLog, FindsAnActionThatDoesNotEnd) {
  Actions actions;
  for (int i = 0; i < 4; ++i) actions.run("pick", "success");
  actions.run("pick", "");
  actions.run("place", "success");
  actions.run("place", "");  // The recording may end before an action does.
  const Reflection found = actions.reflect();
  ASSERT_EQ(found.findings.size(), 1u);
  EXPECT_EQ(found.findings[0].kind, ReflectionKind::kBrokenAction);
  EXPECT_THAT(found.findings[0].found, HasSubstr("pick began and did not end"));
}

TEST(ActionLog, TakesOnlyActions) {
  ActionLog log;
  const MemoryId entity = ExampleArm::id();
  EXPECT_FALSE(log.add(entity, {}, 1.0, {}));
  EXPECT_FALSE(log.add(entity, {}, idf::Dict{{"skill", "pick"}}, {}));
  EXPECT_FALSE(log.add(entity, {}, idf::Dict{{"skill", 3}, {"outcome", true}}, {}));
  EXPECT_TRUE(log.add(entity, {}, idf::Dict{{"skill", "pick"}, {"outcome", true}}, {}));
}

}  // namespace
}  // namespace engram::ltm
