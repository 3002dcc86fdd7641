// SPDX-License-Identifier: Apache-2.0
#include "server/skills/parameter_set.h"

#include "ltm/idf/json.h"
#include "server/skills/skill_description.h"
#include "tests/ltm/expect_status.h"

namespace engram::skills {
namespace {

using ::testing::HasSubstr;

constexpr const char* kDrive = R"(
name: drive
doc: Drives the platform.
parameters:
  to: {type: position, unit: m, doc: Where to.}
  speed: {type: double, unit: m/s, min: 0.01, max: 1, default: 0.2}
  times: {type: int, default: 1}
  object: {type: link, default: Objects/I/k/cup}
  hand: {type: string, choices: [left, right], default: right}
)";

Result<idf::Data> fitted(const char* json) {
  const auto skill = SkillDescription::parse(kDrive);
  if (!skill.ok()) return skill.status();
  const auto given = idf::from_json_text(json);
  if (!given.ok()) return given.status();
  return skill->parameters.fit(*given);
}

TEST(ParameterSet, FillsInDefaultsAndMakesArraysOfLists) {
  const auto values = fitted(R"({"to": [1, 2.5, 0], "speed": 1})");
  ASSERT_OK(values);
  EXPECT_EQ(*values->at("speed"), idf::Data(1.0));
  EXPECT_EQ(*values->at("times"), idf::Data(int64_t{1}));
  EXPECT_EQ(*values->at("hand"), idf::Data("right"));
  EXPECT_EQ(*values->at("to"), idf::Data(idf::NdArray::take({3}, std::vector<double>{1, 2.5, 0})));
  const auto skill = SkillDescription::parse(kDrive);
  const auto links = links_of(skill->parameters, *values);
  ASSERT_EQ(links.size(), 1U);
  EXPECT_EQ(links[0].to_string(), "Objects/I/k/cup");
}

TEST(ParameterSet, NamesEveryPathThatDoesNotFit) {
  const auto bad = fitted(
      R"({"to": [1, 2], "speed": 2, "times": 1.5, "object": "a//b", "hand": "up", "sped": 1})");
  ASSERT_FALSE(bad.ok());
  for (const char* part : {"'to': found", "'speed': found", "'times': found",
                           "'object':", "'hand': found 'up', needs one of left, right",
                           "'sped': there is no such parameter, did you mean 'speed'?"})
    EXPECT_THAT(bad.status().message(), HasSubstr(part));
  EXPECT_FAILS(fitted("{}"), StatusCode::kInvalidArgument, "'to': is missing, needs a position");
  EXPECT_FAILS(fitted("[1]"), StatusCode::kInvalidArgument, "needs a dict");
}

TEST(SkillDescription, SaysWhatIsWrongWithIt) {
  const auto with = [](const char* line) {
    return SkillDescription::parse(fmt::format("name: x\n{}\n", line));
  };
  EXPECT_OK(with(""));
  EXPECT_FAILS(SkillDescription::parse("doc: x"), StatusCode::kInvalidArgument, "'name'");
  EXPECT_FAILS(SkillDescription::parse("name: a/b"), StatusCode::kInvalidArgument, "slash");
  EXPECT_FAILS(with("timeuot: 1s"), StatusCode::kInvalidArgument, "'timeout'");
  EXPECT_FAILS(with("max_running: 0"), StatusCode::kInvalidArgument, "needs 1 to 1000");
  EXPECT_FAILS(with("parameters: {p: {type: duoble}}"), StatusCode::kInvalidArgument, "'duoble'");
  EXPECT_FAILS(with("parameters: {p: {type: int, default: a}}"), StatusCode::kInvalidArgument,
               "'p'");
  EXPECT_FAILS(with("parameters: {p: {type: bool, unit: m}}"), StatusCode::kInvalidArgument,
               "neither unit nor bounds");
  EXPECT_FAILS(with("conditions: {pre: {entity: $o}}"), StatusCode::kInvalidArgument,
               "no parameter 'o'");
  EXPECT_FAILS(with("conditions: {when: {entity: A, binds: o}}"), StatusCode::kInvalidArgument,
               "parameter that is a link");
  EXPECT_FAILS(with("resources: [arm/$hand]"), StatusCode::kInvalidArgument, "no parameter 'hand'");
  EXPECT_FAILS(SkillDescription::parse(std::string(SkillDescription::kMaxBytes + 1, ' ')),
               StatusCode::kInvalidArgument, "at most");
}

}  // namespace
}  // namespace engram::skills
