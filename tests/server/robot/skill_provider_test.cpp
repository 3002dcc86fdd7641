// SPDX-License-Identifier: Apache-2.0
#include "server/client/skill_provider.h"

#include <atomic>
#include <future>
#include <thread>

#include "ltm/skills/skill_ids.h"
#include "server/robot/robot.h"
#include "server/skills/skill_call.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::server {
namespace {

using ::skill::Outcome;
using skills::run_skill;
using skills::SkillResult;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

constexpr const char* kWave = R"(
name: wave
parameters:
  times: {type: int, default: 3, min: 1, max: 10}
)";

/// A robot with one server for everything, and programs that reach it.
class SkillProviderTest : public ::testing::Test {
 protected:
  void start(const std::string& more = "") {
    const std::string yaml = fmt::format(
        "servers: [{{name: all, listen: '{}', store: robot.engram{}}}]", endpoint(), more);
    start_with(yaml);
  }
  void start_with(const std::string& yaml) {
    const auto config = parse_robot_config(yaml, "robot.yaml", folder_.path());
    ASSERT_OK(config);
    auto started = Robot::start(*config);
    ASSERT_OK(started);
    robot_ = *std::move(started);
  }
  [[nodiscard]] std::string endpoint(const char* name = "s") const {
    return fmt::format("unix:{}/{}", folder_.path().string(), name);
  }
  std::unique_ptr<Memory> memory(bool is_name_system = false) {
    auto connected = Memory::connect(endpoint(is_name_system ? "names" : "s"),
                                     {.is_name_system = is_name_system});
    EXPECT_OK(connected);
    return *std::move(connected);
  }

  ScratchDirectory folder_;
  std::unique_ptr<Robot> robot_;
};

TEST_F(SkillProviderTest, RunsASkillOverTheNetwork) {
  start();
  const auto provider = SkillProvider::connect(endpoint(), "arm");
  ASSERT_OK(provider);
  ASSERT_OK((*provider)->add(kWave, [](SkillRun& run) {
    EXPECT_EQ(run.request().names()[1], "ExecutionRequest");
    EXPECT_TRUE(run.report(idf::Dict{{"angle", 0.5}}, {run.execution()}).ok());
    return SkillEnd{
        SkillOutcome::kSuccess, "waved", idf::Dict{{"times", *run.parameters().at("times")}}, {}};
  }));
  const auto asked = memory();
  std::atomic<int> told{0};
  const auto result = run_skill(*asked, {.skill = "wave", .parameters_json = R"({"times": 2})"},
                                [&](const ::skill::Event&) { ++told; });
  ASSERT_OK(result);
  ASSERT_FALSE(result->is_refused) << result->refusal.reason;
  EXPECT_EQ(result->end.outcome, Outcome::SUCCESS);
  EXPECT_EQ(result->end.reason, "waved");
  EXPECT_THAT(result->end.result, HasSubstr("2"));
  EXPECT_EQ(told, 3);
  const auto refused =
      run_skill(*asked, {.skill = "wave", .parameters_json = R"({"times": 20})"}, {});
  ASSERT_OK(refused);
  ASSERT_TRUE(refused->is_refused);
  EXPECT_THAT(refused->refusal.reason, HasSubstr("'times'"));
}

TEST_F(SkillProviderTest, AnExceptionIsAFailureAndAStopReachesTheFunction) {
  start();
  const auto provider = SkillProvider::connect(endpoint(), "p");
  ASSERT_OK(provider);
  ASSERT_OK((*provider)->add(
      "name: throw", [](SkillRun&) -> SkillEnd { throw std::runtime_error("the hand is off"); }));
  ASSERT_OK((*provider)->add("name: wait\ntimeout: 200ms", [](SkillRun& run) {
    while (!run.stop().stop_requested()) std::this_thread::sleep_for(milliseconds(1));
    return SkillEnd::stopped(run.stop_reason());
  }));
  const auto asked = memory();
  const auto thrown = run_skill(*asked, {.skill = "throw"}, {});
  ASSERT_OK(thrown);
  EXPECT_EQ(thrown->end.outcome, Outcome::FAILURE);
  EXPECT_EQ(thrown->end.reason, "the hand is off");
  const auto late = run_skill(*asked, {.skill = "wait"}, {});
  ASSERT_OK(late);
  EXPECT_EQ(late->end.outcome, Outcome::FAILURE);
  EXPECT_THAT(late->end.reason, HasSubstr("it took longer than 200ms"));
}

TEST_F(SkillProviderTest, RefusesWhatItCannotHave) {
  start();
  EXPECT_FAILS(SkillProvider::connect(endpoint(), "a/b"), StatusCode::kInvalidArgument, "slash");
  const auto provider = SkillProvider::connect(endpoint(), "arm");
  ASSERT_OK(provider);
  EXPECT_FAILS(SkillProvider::connect(endpoint(), "arm", {.timeout = milliseconds(300)}),
               StatusCode::kAlreadyExists, "another provider");
  const auto nothing = [](SkillRun&) { return SkillEnd::success(); };
  EXPECT_FAILS((*provider)->add("name: x\nspeed: 1", nothing), StatusCode::kInvalidArgument,
               "speed");
  EXPECT_FAILS((*provider)->add("unknown", nothing), StatusCode::kNotFound, "needs a description");
  ASSERT_OK((*provider)->add("name: x", nothing));
  EXPECT_FAILS((*provider)->add("name: x", nothing), StatusCode::kAlreadyExists, "'x'");
  ASSERT_OK((*provider)->remove("x"));
  EXPECT_FAILS((*provider)->remove("x"), StatusCode::kNotFound, "'x'");
  const auto gone = run_skill(*memory(), {.skill = "x"}, {});
  ASSERT_OK(gone);
  ASSERT_TRUE(gone->is_refused);
  EXPECT_THAT(gone->refusal.reason, HasSubstr("is not there"));
}

TEST_F(SkillProviderTest, GoesOnWhenTheServerIsBack) {
  start();
  const auto provider = SkillProvider::connect(endpoint(), "arm");
  ASSERT_OK(provider);
  std::atomic<int> stops{0};
  ASSERT_OK((*provider)->add("name: hold", [&](SkillRun& run) {
    while (!run.stop().stop_requested()) std::this_thread::sleep_for(milliseconds(1));
    ++stops;
    return SkillEnd::stopped();
  }));
  ASSERT_OK((*provider)->add("name: wave", [](SkillRun&) { return SkillEnd::success(); }));
  {
    const auto asked = memory();
    ASSERT_OK(skills::ask_skill(*asked, "hold", ::skill::Wish::RUN, "test"));
    while ((*provider)->running() == 0) std::this_thread::sleep_for(milliseconds(1));
  }
  robot_.reset();
  while (stops == 0) std::this_thread::sleep_for(milliseconds(1));
  start();
  const auto asked = memory();
  Result<SkillResult> waved = unavailable("not yet");
  for (int i = 0; i < 200; ++i) {
    waved = run_skill(*asked, {.skill = "wave"}, {});
    ASSERT_OK(waved);
    if (!waved->is_refused) break;
    std::this_thread::sleep_for(milliseconds(50));
  }
  EXPECT_FALSE(waved->is_refused) << waved->refusal.reason;
  // What ran when the server went has one end.
  const auto events = asked->query("Skill/Event/arm/hold @ all");
  ASSERT_OK(events);
  EXPECT_EQ(events->entities().front()->snapshots.size(), 2U);
}

TEST_F(SkillProviderTest, WhoWaitsHearsTheEndAlthoughTheServerWasAway) {
  start();
  const auto provider = SkillProvider::connect(endpoint(), "arm");
  ASSERT_OK(provider);
  ASSERT_OK((*provider)->add("name: hold", [](SkillRun& run) {
    while (!run.stop().stop_requested()) std::this_thread::sleep_for(milliseconds(1));
    return SkillEnd::stopped();
  }));
  const auto asked = memory();
  auto result =
      std::async(std::launch::async, [&] { return run_skill(*asked, {.skill = "hold"}, {}); });
  while ((*provider)->running() == 0) std::this_thread::sleep_for(milliseconds(1));
  robot_.reset();
  start();
  ASSERT_EQ(result.wait_for(seconds(30)), std::future_status::ready);
  const auto ended = result.get();
  ASSERT_OK(ended);
  EXPECT_FALSE(ended->is_refused);
  EXPECT_NE(ended->end.outcome, Outcome::SUCCESS);
}

TEST_F(SkillProviderTest, ConditionsLookAtTheMemoriesOfOtherServers) {
  start_with(
      fmt::format("names: {{listen: '{}'}}\n"
                  "servers:\n"
                  "  - {{name: skills, memories: [Skill], listen: '{}', store: skills.engram}}\n"
                  "  - {{name: world, memories: [Objects], listen: '{}', store: world.engram}}\n",
                  endpoint("names"), endpoint("skills"), endpoint("world")));
  const auto provider = SkillProvider::connect(endpoint("names"), "arm", {.is_name_system = true});
  ASSERT_OK(provider);
  std::promise<std::string> seen;
  ASSERT_OK((*provider)->add(
      "name: fetch\nparameters: {object: link}\n"
      "conditions: {when: {entity: Objects, path: is_visible, equals: true, binds: object}}\n",
      [&](SkillRun& run) {
        seen.set_value(run.parameters().at("object")->get<std::string>());
        return SkillEnd::success();
      }));
  const auto asked = memory(true);
  const auto cup = *ltm::MemoryId::parse("Objects/Instances/kitchen/cup");
  ASSERT_OK(asked->commit({{{cup, system_now(), {{idf::Dict{{"is_visible", true}}, {}}}}}}));
  auto told = seen.get_future();
  ASSERT_EQ(told.wait_for(seconds(20)), std::future_status::ready);
  EXPECT_THAT(told.get(), HasSubstr("kitchen/cup/"));
}

TEST_F(SkillProviderTest, AConditionAttendsToWhatIsSensory) {
  start(", segments: [{match: Vision, sensory: 10s}]");
  const auto asked = memory();
  const auto camera = *ltm::MemoryId::parse("Vision/RGB/head/cam");
  const auto see = [&](bool is_dark) {
    EXPECT_OK(asked->commit({{{camera, system_now(), {{idf::Dict{{"is_dark", is_dark}}, {}}}}}}));
  };
  see(false);
  const auto provider = SkillProvider::connect(endpoint(), "p");
  ASSERT_OK(provider);
  std::promise<void> switched;
  ASSERT_OK((*provider)->add(
      "name: light\nconditions: {when: {entity: Vision, path: is_dark, equals: true}}\n",
      [&](SkillRun&) {
        switched.set_value();
        return SkillEnd::success();
      }));
  see(true);
  EXPECT_EQ(switched.get_future().wait_for(seconds(20)), std::future_status::ready);
}

TEST_F(SkillProviderTest, AnswersRequestsAlthoughThereIsNoProvider) {
  start();
  const auto asked = memory();
  const auto refused = run_skill(*asked, {.skill = "wave"}, {});
  ASSERT_OK(refused);
  ASSERT_TRUE(refused->is_refused);
  EXPECT_THAT(refused->refusal.reason, HasSubstr("there is no such skill"));
}

TEST_F(SkillProviderTest, AServerMayHaveNoSkills) {
  start(", skills: false");
  EXPECT_FAILS(SkillProvider::connect(endpoint(), "arm"), StatusCode::kFailedPrecondition,
               "has no skill memory");
}

TEST_F(SkillProviderTest, AnEntityTellsTheTimeOfASimulation) {
  start(", skills: {clock: Simulation/Clock/kitchen/clock}");
  const auto provider = SkillProvider::connect(endpoint(), "p");
  ASSERT_OK(provider);
  const auto asked = memory();
  const auto clock = *ltm::MemoryId::parse("Simulation/Clock/kitchen/clock");
  const Time begin = time_from_ns(1'767'254'400'000'000'000);
  const auto tell = [&](milliseconds after) {
    EXPECT_OK(asked->commit({{{clock, begin + after, {{idf::Data(true), {}}}}}}));
  };
  tell(milliseconds(0));
  std::atomic<bool> is_stopped{false};
  ASSERT_OK((*provider)->add("name: wait\ntimeout: 10s", [&](SkillRun& run) {
    while (!run.stop().stop_requested()) std::this_thread::sleep_for(milliseconds(1));
    is_stopped = true;
    return SkillEnd::stopped();
  }));
  auto result =
      std::async(std::launch::async, [&] { return run_skill(*asked, {.skill = "wait"}, {}); });
  while ((*provider)->running() == 0) std::this_thread::sleep_for(milliseconds(1));
  tell(seconds(9));
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_FALSE(is_stopped);
  tell(seconds(10));
  const auto ended = result.get();
  ASSERT_OK(ended);
  EXPECT_EQ(ended->end.outcome, Outcome::FAILURE);
  EXPECT_GE(*ended->end.ended - ended->end.started, seconds(10));
  EXPECT_LT(*ended->end.ended - ended->end.started, seconds(11));
}

}  // namespace
}  // namespace engram::server
