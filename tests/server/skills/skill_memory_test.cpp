// SPDX-License-Identifier: Apache-2.0
#include "server/skills/skill_memory.h"

#include <future>

#include "ltm/memory/links.h"
#include "tests/server/skills/skill_robot.h"

namespace engram::skills {
namespace {

using engram::testing::PlainProvider;
using engram::testing::SkillRobot;
using ::skill::Event;
using ::skill::Outcome;
using ::skill::Refusal;
using ::skill::Stage;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

constexpr const char* kGrasp = R"(
name: grasp
parameters:
  object: {type: link}
  hand: {type: string, choices: [left, right], default: right}
conditions:
  pre: {entity: $object, path: is_visible, equals: true}
  hold: {not: {entity: Speech, path: text, matches: '(?i)stop.*', new: true}}
  post: {entity: $object, path: held_by, equals: $hand}
  post_within: 200ms
resources: [arm/$hand]
timeout: 20s
)";

constexpr const char* kCup = "Objects/Instances/kitchen/cup";

/// Asks for a skill from a thread of its own.
std::future<Result<SkillResult>> ask(Memory& memory, SkillRequest request) {
  return std::async(std::launch::async, [&memory, request = std::move(request)] {
    return run_skill(memory, request, {});
  });
}

SkillRequest grasp_of(const std::string& object) {
  return {.skill = "grasp", .parameters_json = fmt::format(R"({{"object": "{}"}})", object)};
}

TEST(SkillMemory, StartsWhatIsAskedForAndTellsHowItEnded) {
  SkillRobot robot;
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("arm", {kGrasp});
  ASSERT_OK(provider->welcomed());
  robot.commit(kCup, idf::Dict{{"is_visible", true}, {"held_by", ""}});
  auto result = ask(*robot.memory, grasp_of(kCup));
  const SkillStart start = provider->started();
  EXPECT_EQ(start.skill, "grasp");
  EXPECT_THAT(start.parameters_json, HasSubstr(R"("hand":"right")"));
  provider->report(start.execution, R"({"closed": 0.4})", {kCup});
  robot.commit(kCup, idf::Dict{{"is_visible", true}, {"held_by", "right"}});
  provider->end(start.execution);
  const auto ended = result.get();
  ASSERT_OK(ended);
  ASSERT_FALSE(ended->is_refused);
  EXPECT_EQ(ended->end.outcome, Outcome::SUCCESS);

  const auto events = robot.all<Event>("Event");
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[0].stage, Stage::STARTED);
  EXPECT_EQ(events[1].stage, Stage::INTERMEDIATE);
  EXPECT_EQ(events[1].results.front().to_string(), kCup);
  EXPECT_EQ(events[2].stage, Stage::ENDED);
  EXPECT_EQ(events[2].execution->to_string(), start.execution);
  EXPECT_EQ(events[2].inputs.front().to_string(), kCup);
  EXPECT_EQ(events[0].running.size(), 1U);
  EXPECT_TRUE(events[2].running.empty());
  // What it says leads to something that is there.
  for (const Event& event : events)
    for (const ltm::MemoryId& id : {event.request, event.executable, ended->end_id}) {
      const auto found =
          robot.memory->query(ltm::Query::of_entity(id.entity(), ltm::select::At{*id.time()}), "");
      ASSERT_OK(found);
      EXPECT_NE(found->find_instance(id), nullptr) << id.to_string();
    }
}

TEST(SkillMemory, SaysWhichConditionWasNotMet) {
  SkillRobot robot;
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("arm", {kGrasp});
  ASSERT_OK(provider->welcomed());
  const auto unknown = run_skill(*robot.memory, grasp_of("Objects/Instances/kitchen/salt"), {});
  ASSERT_OK(unknown);
  ASSERT_TRUE(unknown->is_refused);
  EXPECT_THAT(unknown->refusal.reason, HasSubstr("no snapshot of such an entity yet"));
  robot.commit(kCup, idf::Dict{{"is_visible", false}});
  const auto hidden = run_skill(*robot.memory, grasp_of(kCup), {});
  ASSERT_OK(hidden);
  ASSERT_TRUE(hidden->is_refused);
  EXPECT_THAT(hidden->refusal.reason, HasSubstr("is_visible equals true (found false)"));
  ASSERT_EQ(hidden->refusal.found.size(), 1U);
  EXPECT_EQ(hidden->refusal.found[0].entity().to_string(), kCup);
  EXPECT_EQ(provider->starts(), 0U);
}

TEST(SkillMemory, RefusesWithTheReason) {
  SkillRobot robot;
  const auto refused = [&](SkillRequest request) {
    const auto result = run_skill(*robot.memory, request, {});
    EXPECT_OK(result);
    return result.ok() && result->is_refused ? result->refusal.reason : std::string("not refused");
  };
  EXPECT_THAT(refused({.skill = "grasp"}), HasSubstr("there is no such skill"));
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("arm", {kGrasp});
  ASSERT_OK(provider->welcomed());
  EXPECT_THAT(refused({.skill = "grap"}), HasSubstr("did you mean 'grasp'?"));
  EXPECT_THAT(refused({.skill = "grasp"}), HasSubstr("'object': is missing, needs a link"));
  EXPECT_THAT(refused({.skill = "grasp", .parameters_json = "{"}), HasSubstr("parameters"));
  SkillRequest other = grasp_of(kCup);
  other.version = "2";
  EXPECT_THAT(refused(other), HasSubstr("has version 1, but version 2 was asked for"));
  ASSERT_OK(ask_skill(*robot.memory, "grasp", ::skill::Wish::DISABLE, "test"));
  EXPECT_THAT(refused(grasp_of(kCup)), HasSubstr("is disabled"));
  ASSERT_OK(ask_skill(*robot.memory, "grasp", ::skill::Wish::ENABLE, "test"));
  EXPECT_THAT(refused(grasp_of(kCup)), HasSubstr("its condition is not met"));
  provider->go();
  EXPECT_THAT(refused(grasp_of(kCup)), HasSubstr("its provider 'arm' is not there"));
}

TEST(SkillMemory, WaitsForConditionsAndResources) {
  SkillRobot robot;
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("arm", {"name: a\nresources: [arm]\n", "name: b\nresources: [arm/left]\n"});
  ASSERT_OK(provider->welcomed());
  auto first = ask(*robot.memory, {.skill = "a"});
  const SkillStart start = provider->started();
  const auto busy = run_skill(*robot.memory, {.skill = "b"}, {});
  ASSERT_OK(busy);
  ASSERT_TRUE(busy->is_refused);
  EXPECT_THAT(busy->refusal.reason, HasSubstr("'arm/left' is used by 'arm/a'"));
  EXPECT_EQ(busy->refusal.found.front().to_string(), start.execution);
  auto second = ask(*robot.memory, {.skill = "b", .wait = seconds(20)});
  while (robot.skills->counters().waiting == 0) std::this_thread::sleep_for(milliseconds(1));
  provider->end(start.execution);
  provider->end(provider->started(1).execution);
  for (auto* result : {&first, &second}) {
    const auto ended = result->get();
    ASSERT_OK(ended);
    EXPECT_FALSE(ended->is_refused);
  }
}

TEST(SkillMemory, StopsWhatItsConditionNoLongerAllows) {
  SkillRobot robot;
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("arm", {kGrasp});
  ASSERT_OK(provider->welcomed());
  robot.say("Stop!");
  robot.commit(kCup, idf::Dict{{"is_visible", true}});
  auto result = ask(*robot.memory, grasp_of(kCup));
  const SkillStart start = provider->started();
  robot.say("Stop it!");
  const auto [execution, reason] = provider->told_to_stop();
  EXPECT_EQ(execution, start.execution);
  EXPECT_THAT(reason, HasSubstr("does not hold any more"));
  provider->end(execution, SkillOutcome::kStop, "at rest");
  const auto ended = result.get();
  ASSERT_OK(ended);
  EXPECT_EQ(ended->end.outcome, Outcome::STOP);
  EXPECT_THAT(ended->end.reason, HasSubstr("found 'Stop it!'"));
  ASSERT_EQ(ended->end.stopped_by.size(), 1U);
  EXPECT_EQ(ended->end.stopped_by[0].names()[0], "Speech");
}

TEST(SkillMemory, FailsIfWhatMustBeSoAfterwardsIsNot) {
  SkillRobot robot;
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("arm", {kGrasp});
  ASSERT_OK(provider->welcomed());
  robot.commit(kCup, idf::Dict{{"is_visible", true}, {"held_by", "left"}});
  auto result = ask(*robot.memory, grasp_of(kCup));
  provider->end(provider->started().execution);
  const auto ended = result.get();
  ASSERT_OK(ended);
  EXPECT_EQ(ended->end.outcome, Outcome::FAILURE);
  EXPECT_THAT(ended->end.reason, HasSubstr("held_by equals 'right' (found 'left')"));
}

TEST(SkillMemory, StopsOnRequestAndWhenItTakesTooLong) {
  SkillRobot robot;
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("p", {"name: slow\n", "name: late\ntimeout: 50ms\nstops_within: 50ms\n"});
  ASSERT_OK(provider->welcomed());
  std::stop_source stop;
  auto slow = std::async(std::launch::async, [&] {
    return run_skill(*robot.memory, {.skill = "slow"}, {}, stop.get_token());
  });
  const SkillStart start = provider->started();
  stop.request_stop();
  EXPECT_EQ(provider->told_to_stop().first, start.execution);
  provider->end(start.execution, SkillOutcome::kStop, "");
  const auto stopped = slow.get();
  ASSERT_OK(stopped);
  EXPECT_EQ(stopped->end.outcome, Outcome::STOP);
  EXPECT_EQ(stopped->end.stopped_by.front().names()[1], "ExecutionRequest");
  // This one never answers.
  const auto late = run_skill(*robot.memory, {.skill = "late"}, {});
  ASSERT_OK(late);
  EXPECT_EQ(late->end.outcome, Outcome::FAILURE);
  EXPECT_THAT(late->end.reason, HasSubstr("took longer than 50ms"));
}

TEST(SkillMemory, WhoGivesUpStopsItsOwnRequestAlone) {
  SkillRobot robot;
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("p", {"name: one\n"});
  ASSERT_OK(provider->welcomed());
  auto first = ask(*robot.memory, {.skill = "one"});
  const SkillStart start = provider->started();
  std::stop_source stop;
  auto second = std::async(std::launch::async, [&] {
    return run_skill(*robot.memory, {.skill = "one", .requester = "other", .wait = seconds(20)}, {},
                     stop.get_token());
  });
  while (robot.skills->counters().waiting == 0) std::this_thread::sleep_for(milliseconds(1));
  stop.request_stop();
  const auto given_up = second.get();
  ASSERT_OK(given_up);
  ASSERT_TRUE(given_up->is_refused);
  EXPECT_THAT(given_up->refusal.reason, HasSubstr("asked to stop it while it waited"));
  provider->end(start.execution);
  const auto ended = first.get();
  ASSERT_OK(ended);
  EXPECT_EQ(ended->end.outcome, Outcome::SUCCESS);
}

TEST(SkillMemory, AProviderThatGoesAfterItsEndHasEnded) {
  SkillRobot robot;
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("p", {"name: a\nconditions: {post: {entity: World, path: x, equals: 1}, "
                       "post_within: 20s}\n"});
  ASSERT_OK(provider->welcomed());
  auto result = ask(*robot.memory, {.skill = "a"});
  provider->end(provider->started().execution);
  provider->go();
  const auto ended = result.get();
  ASSERT_OK(ended);
  EXPECT_EQ(ended->end.outcome, Outcome::FAILURE);
  EXPECT_THAT(ended->end.reason, HasSubstr("what must be so afterwards is not"));
}

TEST(SkillMemory, ConditionsStartASkillOncePerChange) {
  SkillRobot robot;
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("arm", {R"(
name: fetch
parameters: {object: link}
conditions:
  when: {entity: Objects, path: is_visible, equals: true, binds: object}
)"});
  ASSERT_OK(provider->welcomed());
  robot.commit(kCup, idf::Dict{{"is_visible", false}});
  for (int i = 0; i < 5; ++i) robot.commit(kCup, idf::Dict{{"is_visible", true}});
  const SkillStart start = provider->started();
  EXPECT_THAT(start.parameters_json, HasSubstr(kCup));
  provider->end(start.execution);
  robot.commit(kCup, idf::Dict{{"is_visible", false}});
  robot.commit(kCup, idf::Dict{{"is_visible", true}});
  provider->end(provider->started(1).execution);
  while (robot.skills->counters().ended < 2) std::this_thread::sleep_for(milliseconds(1));
  EXPECT_EQ(provider->starts(), 2U);
  const auto requests = robot.all<::skill::ExecutionRequest>("ExecutionRequest/conditions");
  ASSERT_EQ(requests.size(), 2U);
  ASSERT_EQ(requests[0].causes.size(), 1U);
  EXPECT_EQ(requests[0].causes[0].entity().to_string(), kCup);
  for (const Event& event : robot.all<Event>("Event"))
    EXPECT_EQ(event.request.names()[2], "conditions");
}

TEST(SkillMemory, AProviderThatGoesLeavesLostAndAnotherOfItsNameMustWait) {
  SkillRobot robot;
  const auto first = PlainProvider::create(*robot.skills);
  const auto second = PlainProvider::create(*robot.skills);
  first->come("arm", {"name: a\n"});
  ASSERT_OK(first->welcomed());
  second->come("arm", {"name: a\n"});
  EXPECT_FAILS(second->welcomed(), StatusCode::kAlreadyExists, "another provider of this name");
  auto result = ask(*robot.memory, {.skill = "a"});
  const SkillStart start = first->started();
  first->go();
  const auto ended = result.get();
  ASSERT_OK(ended);
  EXPECT_EQ(ended->end.outcome, Outcome::LOST);
  // What it says afterwards counts no more.
  first->end(start.execution);
  const auto third = PlainProvider::create(*robot.skills);
  third->come("arm", {"a"});
  ASSERT_OK(third->welcomed());
  EXPECT_EQ(robot.all<Event>("Event").size(), 2U);
}

TEST(SkillMemory, EndsWhatRanWhenItIsOpenedAgain) {
  SkillRobot robot;
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("arm", {"name: a\nmax_running: 3\n"});
  ASSERT_OK(provider->welcomed());
  for (size_t i = 0; i < 3; ++i) {
    ASSERT_OK(ask_skill(*robot.memory, "a", ::skill::Wish::RUN, fmt::format("test{}", i)));
    const SkillStart start = provider->started(i);
    EXPECT_FALSE(start.execution.empty());
  }
  // As after a kill: the starts are there and nothing else.
  const auto events = robot.all<Event>("Event");
  ASSERT_EQ(events.size(), 3U);
  ::skill::Event last = events.back();
  EXPECT_EQ(last.running.size(), 3U);
  robot.close();
  robot.open();
  // close() told it to stop, and it did not answer: all three are lost, once each.
  std::map<std::string, int> ends;
  for (const Event& event : robot.all<Event>("Event")) {
    if (event.stage != Stage::ENDED) continue;
    EXPECT_EQ(event.outcome, Outcome::LOST);
    ++ends[event.execution->to_string()];
  }
  EXPECT_EQ(ends.size(), 3U);
  for (const auto& [execution, count] : ends) EXPECT_EQ(count, 1) << execution;
  const auto skills = list_skills(*robot.memory);
  ASSERT_OK(skills);
  ASSERT_EQ(skills->size(), 1U);
  EXPECT_FALSE(*skills->front().second.is_available);
}

TEST(SkillMemory, KnownBeforeAndAnotherVersion) {
  SkillRobot robot;
  robot.skills.reset();
  ::skill::Executable known;
  known.description = "name: wave\nversion: 2\n";
  const ltm::MemoryId entity = executable_id({"arm", "wave"});
  ASSERT_OK(
      robot.memory->commit({{{entity, system_now(), {{known.to_idf(), {.provider = "prior"}}}}}}));
  auto started = SkillMemory::start(*robot.memory, {});
  ASSERT_OK(started);
  robot.skills = *std::move(started);
  const auto old = PlainProvider::create(*robot.skills);
  old->come("arm", {"name: wave\nversion: 1\n"});
  EXPECT_FAILS(old->welcomed(), StatusCode::kFailedPrecondition,
               "has version 1, but version 2 is known before");
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("arm", {"wave"});
  ASSERT_OK(provider->welcomed());
  auto result = ask(*robot.memory, {.skill = "arm/wave"});
  provider->end(provider->started().execution);
  ASSERT_OK(result.get());
}

TEST(SkillMemory, ExplainsWhatASkillWaitsFor) {
  SkillRobot robot;
  const auto provider = PlainProvider::create(*robot.skills);
  provider->come("arm", {kGrasp});
  ASSERT_OK(provider->welcomed());
  const auto told =
      explain_skill(*robot.memory, "grasp", fmt::format(R"({{"object": "{}"}})", kCup));
  ASSERT_OK(told);
  ASSERT_EQ(told->conditions.size(), 3U);
  EXPECT_EQ(told->conditions[0].name, "pre");
  EXPECT_FALSE(told->conditions[0].is_met);
  EXPECT_EQ(told->conditions[0].unmet.front().found, "no snapshot of such an entity yet");
  EXPECT_TRUE(told->conditions[1].is_met);
  const auto without = explain_skill(*robot.memory, "grasp", {});
  ASSERT_OK(without);
  EXPECT_EQ(without->needs_parameters, (std::vector<std::string>{"pre", "post"}));
  EXPECT_FAILS(explain_skill(*robot.memory, "gasp", {}), StatusCode::kNotFound,
               "did you mean 'grasp'?");
}

}  // namespace
}  // namespace engram::skills
