// SPDX-License-Identifier: Apache-2.0
#include "server/skills/skill_condition.h"

#include "server/skills/condition_state.h"
#include "tests/ltm/expect_status.h"

namespace engram::skills {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const Time kStart = time_from_ns(1'700'000'000'000'000'000);

Result<Condition> condition(std::string_view yaml) {
  auto value = ConfigValue::parse(yaml, "test");
  if (!value.ok()) return value.status();
  return read_condition(*value);
}

ConditionState state_of(std::string_view yaml) {
  const auto read = condition(yaml);
  ENGRAM_CHECK(read.ok(), "{}", read.status().message());
  auto state = ConditionState::create(*read);
  ENGRAM_CHECK(state.ok(), "{}", state.status().message());
  return *std::move(state);
}

ltm::Snapshot snapshot(std::string_view entity, milliseconds at, idf::Data value) {
  return {*ltm::MemoryId::parse(entity), kStart + at, {{std::move(value), {}}}};
}

idf::Data seen(bool is_visible) {
  return idf::Dict{{"is_visible", is_visible}};
}

bool met_after(ConditionState& state, const ltm::Snapshot& what) {
  state.offer(what);
  return state.is_met(what.time);
}

TEST(Condition, SaysWhatIsWrongWithIt) {
  EXPECT_FAILS(condition("{path: x, bound: 1}"), StatusCode::kInvalidArgument, "entity");
  EXPECT_FAILS(condition("{entity: A, path: x}"), StatusCode::kInvalidArgument,
               "needs one of bound, equals and matches");
  EXPECT_FAILS(condition("{entity: A, bound: 1}"), StatusCode::kInvalidArgument, "'path'");
  EXPECT_FAILS(condition("{entity: A, path: x, bound: 1, equals: 2}"), StatusCode::kInvalidArgument,
               "needs one");
  EXPECT_FAILS(condition("{entity: A, path: x, matches: '('}"), StatusCode::kInvalidArgument,
               "regular expression");
  EXPECT_FAILS(condition("{entity: A, path: x, bound: 1, crosses: either}"),
               StatusCode::kInvalidArgument, "new: true");
  EXPECT_FAILS(condition("{entity: A, new: true, for: 1s}"), StatusCode::kInvalidArgument,
               "moment");
  EXPECT_FAILS(condition("{any: []}"), StatusCode::kInvalidArgument, "empty list");
  EXPECT_FAILS(condition("{all: [{entity: A}], any: [{entity: B}]}"), StatusCode::kInvalidArgument,
               "several");
  EXPECT_FAILS(condition("{entity: A, paht: x}"), StatusCode::kInvalidArgument, "'path'");
  EXPECT_FAILS(condition("{entity: 'A/B/C/D/E'}"), StatusCode::kInvalidArgument, "A/B/C/D/E");
}

TEST(Condition, IsTrueOfAStateAsLongAsTheLastSnapshotIsSo) {
  ConditionState state = state_of("{entity: Objects/.*/.*/cup, path: is_visible, equals: true}");
  EXPECT_FALSE(state.is_met(kStart));
  EXPECT_FALSE(met_after(state, snapshot("Objects/I/k/box", milliseconds(1), seen(true))));
  EXPECT_TRUE(met_after(state, snapshot("Objects/I/k/cup", milliseconds(2), seen(true))));
  EXPECT_TRUE(state.is_met(kStart + std::chrono::hours(1)));
  EXPECT_FALSE(met_after(state, snapshot("Objects/I/k/cup", milliseconds(3), seen(false))));
  // A snapshot that comes late does not tell what is the case now.
  EXPECT_FALSE(met_after(state, snapshot("Objects/I/k/cup", milliseconds(2), seen(true))));
}

TEST(Condition, OfSeveralEntitiesOneIsEnough) {
  ConditionState state = state_of("{entity: Objects, path: x, bound: 2}");
  EXPECT_FALSE(met_after(state, snapshot("Objects/I/k/a", milliseconds(1), idf::Dict{{"x", 1.0}})));
  EXPECT_TRUE(met_after(state, snapshot("Objects/I/k/b", milliseconds(2), idf::Dict{{"x", 2.0}})));
  EXPECT_TRUE(met_after(state, snapshot("Objects/I/k/a", milliseconds(3), idf::Dict{{"x", 0.0}})));
  EXPECT_THAT(state.causes(),
              ElementsAre(*ltm::MemoryId::parse(
                  snapshot("Objects/I/k/b", milliseconds(2), 0.0).id().to_string() + "/0")));
}

TEST(Condition, BoundsOfArraysAskEachElementAndNanIsNothing) {
  ConditionState state = state_of("{entity: A, path: t, bound: 5, crosses: falling}");
  const auto numbers = [](std::vector<float> values) {
    const auto count = static_cast<int64_t>(values.size());
    return idf::Data(idf::Dict{{"t", idf::NdArray::take({count}, std::move(values))}});
  };
  EXPECT_FALSE(met_after(state, snapshot("A/b/c/d", milliseconds(1), numbers({6, 7, NAN}))));
  EXPECT_TRUE(met_after(state, snapshot("A/b/c/d", milliseconds(2), numbers({6, 4.9F}))));
  EXPECT_FALSE(met_after(state, snapshot("A/b/c/d", milliseconds(3), numbers({}))));
}

TEST(Condition, HoldsForATime) {
  ConditionState state = state_of("{entity: A, path: x, equals: 1, for: 500ms}");
  const auto at = [&](int ms, double x) {
    return met_after(state, snapshot("A/b/c/d", milliseconds(ms), idf::Dict{{"x", x}}));
  };
  EXPECT_FALSE(at(0, 1));
  EXPECT_EQ(state.next_change(kStart), kStart + milliseconds(500));
  EXPECT_FALSE(at(400, 1));
  EXPECT_FALSE(at(450, 0));
  EXPECT_FALSE(state.is_met(kStart + milliseconds(600)));
  EXPECT_FALSE(at(700, 1));
  EXPECT_FALSE(state.is_met(kStart + milliseconds(1199)));
  EXPECT_TRUE(state.is_met(kStart + milliseconds(1200)));
}

TEST(Condition, WhatIsNewIsSoForOneMoment) {
  ConditionState state = state_of("{entity: Speech, path: text, matches: '(?i)stop!?', new: true}");
  const auto said = [](int ms, const char* text) {
    return snapshot("Speech/C/h/t", milliseconds(ms), idf::Dict{{"text", text}});
  };
  // What was said before is not new.
  state.seed(said(0, "Stop!"));
  EXPECT_FALSE(state.is_met(kStart));
  EXPECT_FALSE(met_after(state, said(1, "go on")));
  EXPECT_TRUE(met_after(state, said(2, "STOP")));
  EXPECT_FALSE(state.is_met(kStart + milliseconds(2)));
}

TEST(Condition, CrossesABoundAsEventRulesDo) {
  ConditionState state = state_of("{entity: A, path: v, bound: 3, crosses: either, new: true}");
  const auto at = [&](int ms, double v) {
    return met_after(state, snapshot("A/b/c/d", milliseconds(ms), idf::Dict{{"v", v}}));
  };
  EXPECT_FALSE(at(1, 1));
  EXPECT_TRUE(at(2, 3));
  EXPECT_FALSE(at(3, 4));
  EXPECT_TRUE(at(4, 2));
}

TEST(Condition, IsTooOldAfterAWhile) {
  ConditionState state = state_of("{entity: A, path: x, equals: true, max_age: 100ms}");
  EXPECT_TRUE(met_after(state, snapshot("A/b/c/d", milliseconds(0), idf::Dict{{"x", true}})));
  EXPECT_TRUE(state.is_met(kStart + milliseconds(100)));
  const auto change = state.next_change(kStart + milliseconds(50));
  ASSERT_TRUE(change);
  EXPECT_FALSE(state.is_met(*change));
}

TEST(Condition, JoinsByAllAnyAndNot) {
  ConditionState state = state_of(
      "all: [{any: [{entity: A, path: x, equals: 1}, {entity: B, path: x, equals: 1}]}, "
      "{not: {entity: C, path: x, equals: 1}}]");
  const auto at = [&](const char* memory, int ms, double x) {
    return met_after(
        state, snapshot(fmt::format("{}/b/c/d", memory), milliseconds(ms), idf::Dict{{"x", x}}));
  };
  EXPECT_FALSE(at("A", 1, 0));
  EXPECT_TRUE(at("B", 2, 1));
  EXPECT_FALSE(at("C", 3, 1));
  const auto unmet = state.unmet(kStart + milliseconds(3));
  ASSERT_EQ(unmet.size(), 1U);
  EXPECT_THAT(unmet[0].to_string(), HasSubstr("not C: x equals 1 (found 1)"));
  EXPECT_EQ(unmet[0].where->names()[0], "C");
  EXPECT_TRUE(at("C", 4, 0));
}

TEST(Condition, SaysThatItWaitsForAnEntityThatIsNotThere) {
  ConditionState state = state_of("{entity: Objects/I/k/salt, path: x, equals: 1}");
  EXPECT_FALSE(state.is_met(kStart));
  const auto unmet = state.unmet(kStart);
  ASSERT_EQ(unmet.size(), 1U);
  EXPECT_EQ(unmet[0].found, "no snapshot of such an entity yet");
  EXPECT_FALSE(unmet[0].where);
}

TEST(Condition, BindsWhatMetItToAParameter) {
  ConditionState state =
      state_of("{entity: Objects, path: is_visible, equals: true, binds: object}");
  EXPECT_TRUE(met_after(state, snapshot("Objects/I/k/cup", milliseconds(1), seen(true))));
  ASSERT_TRUE(state.bound().contains("object"));
  EXPECT_EQ(state.bound().at("object").names()[3], "cup");
}

TEST(Condition, TakesValuesOfParameters) {
  const auto read = condition("{entity: $object, path: held_by, equals: $hand}");
  ASSERT_OK(read);
  EXPECT_THAT(parameters_in(*read), ElementsAre("hand", "object"));
  const idf::Data parameters = idf::Dict{{"object", "Objects/I/k/a.b"}, {"hand", "left"}};
  const auto filled = with_parameters(*read, parameters);
  ASSERT_OK(filled);
  auto state = ConditionState::create(*filled);
  ASSERT_OK(state);
  const auto held = [](const char* entity, int ms) {
    return snapshot(entity, milliseconds(ms), idf::Dict{{"held_by", "left"}});
  };
  // A dot of a name is no pattern.
  EXPECT_FALSE(met_after(*state, held("Objects/I/k/aXb", 1)));
  EXPECT_TRUE(met_after(*state, held("Objects/I/k/a.b", 2)));
  EXPECT_FAILS(with_parameters(*read, idf::Dict{{"hand", "left"}}), StatusCode::kInvalidArgument,
               "$object");
  EXPECT_FAILS(with_parameters(*read, idf::Dict{{"object", "Objects"}, {"hand", "l"}}),
               StatusCode::kInvalidArgument, "needs an entity");
}

}  // namespace
}  // namespace engram::skills
