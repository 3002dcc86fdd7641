// SPDX-License-Identifier: Apache-2.0
#include "reports/plain/shown_value.h"

#include <cmath>

#include "tests/ltm/expect_status.h"

namespace engram::reports {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

idf::Data example() {
  return idf::Dict{
      {"image", idf::NdArray::take<uint8_t>({8, 9, 3}, std::vector<uint8_t>(216))},
      {"joints", idf::NdArray::take<double>({2, 2}, {1, 2, 3, 4})},
      {"long", idf::NdArray::take<float>({70}, std::vector<float>(70, 2.0f))},
      {"pose", idf::Dict{{"position", idf::NdArray::take<float>({3}, {1, 2, 3})},
                         {"orientation", idf::NdArray::take<float>({4}, {1, 0, 0, 0})}}},
      {"a/b", 5},
      {"$odd", true},
      {"name", "cup"},
      {"seen", "Vision/RGB/head/cam/2022-02-18 13:06:56.492182"}};
}

TEST(ShownValue, LeavesOutWhatNobodyReads) {
  const auto json = shown_value(example(), std::nullopt);
  ASSERT_OK(json);
  EXPECT_EQ(json->at("image").dump(),
            R"({"$image":{"path":"image","width":9,"height":8,"channels":3,"dtype":"uint8"}})");
  EXPECT_EQ(
      json->at("long").dump(),
      R"({"$array":{"shape":[70],"dtype":"float32","summary":{"min":2.0,"max":2.0,"mean":2.0}}})");
  EXPECT_EQ(json->at("seen").dump(),
            R"({"$link":"Vision/RGB/head/cam/2022-02-18 13:06:56.492182"})");
  EXPECT_EQ(json->at("a/b").dump(), R"({"$int32":5})");
  EXPECT_EQ(json->at("$$odd").dump(), "true");
  EXPECT_EQ(json->at("name").dump(), R"("cup")");
  EXPECT_EQ(json->at("joints").dump(),
            R"({"$ndarray":{"type":"float64","shape":[2,2],"data":[1.0,2.0,3.0,4.0]}})");
}

TEST(ShownValue, CutsLongLists) {
  const auto json = shown_value(idf::List(1005, idf::Data("x")), std::nullopt);
  ASSERT_OK(json);
  EXPECT_EQ(json->size(), 1001u);
  EXPECT_EQ(json->back().dump(), R"({"$more":5})");
}

TEST(ShownValue, SummarizesNumbersThatAreNone) {
  const float kNan = std::nanf("");
  const auto json =
      shown_value(idf::NdArray::take<float>({65}, std::vector<float>(65, kNan)), std::nullopt);
  ASSERT_OK(json);
  EXPECT_EQ((*json)["$array"]["summary"].dump(), R"({"min":null,"max":null,"mean":null})");
}

TEST(ShownMembers, NameEachNumber) {
  std::vector<std::string> texts;
  for (const ShownMember& member : shown_members(example(), std::nullopt))
    if (!member.path.starts_with("long")) texts.push_back(member.kind + " " + member.path);
  EXPECT_THAT(texts, ElementsAre("image image", "number joints[0,0]", "number joints[0,1]",
                                 "number joints[1,0]", "number joints[1,1]", "pose pose",
                                 "number pose/position[0]", "number pose/position[1]",
                                 "number pose/position[2]", "number pose/orientation[0]",
                                 "number pose/orientation[1]", "number pose/orientation[2]",
                                 "number pose/orientation[3]", "number a\\/b", "number $odd",
                                 "text name", "link seen"));
}

TEST(ShownMembers, HaveTheNumbersThatTheirPathsName) {
  const idf::Data value = example();
  for (const ShownMember& member : shown_members(value, std::nullopt)) {
    if (member.kind != "number") continue;
    EXPECT_FALSE(std::isnan(number_at(value, member.path))) << member.path;
  }
  EXPECT_EQ(number_at(value, "joints[1,0]"), 3);
  EXPECT_EQ(number_at(value, "a\\/b"), 5);
  EXPECT_EQ(number_at(value, "$odd"), 1);
}

TEST(ShownMembers, AreNotFoundAtPathsThatAreNone) {
  const idf::Data value = example();
  for (const char* path : {"", "none", "joints", "joints[", "joints[]", "joints[2,0]", "joints[0]",
                           "joints[-1,0]", "joints[0,0,0]", "joints[99999999999999999999,0]",
                           "name", "name[0]", "[0]", "]", "[", "image[8,0,0]", "joints[a,b]"})
    EXPECT_TRUE(std::isnan(number_at(value, path))) << path;
  EXPECT_EQ(image_at(value, "joints"), nullptr);
  EXPECT_EQ(image_at(value, ""), nullptr);
  EXPECT_NE(image_at(value, "image"), nullptr);
}

TEST(ShownMembers, TellUnitsOfTheirType) {
  const idf::Type type = idf::Type::object(
      "Arm", {{"joints", idf::Type::ndarray(idf::ElementType::kFloat64, {2}, {"rad"})},
              {"cup", idf::Type::memory_link()},
              {"lengths", idf::Type::list(idf::Type::float64({"m", 0.0, 2.0}))}});
  EXPECT_EQ(unit_at(type, "joints[1]"), "rad");
  EXPECT_EQ(unit_at(type, "lengths/5"), "m");
  EXPECT_EQ(unit_at(type, "none"), "");
  EXPECT_EQ(unit_at(std::nullopt, "joints[1]"), "");
  const idf::Data value = idf::Dict{{"joints", idf::NdArray::take<double>({2}, {1, 2})},
                                    {"cup", "Objects/Things/kitchen/cup"},
                                    {"lengths", idf::List{0.5}}};
  const auto members = shown_members(value, type);
  ASSERT_EQ(members.size(), 4u);
  EXPECT_EQ(members[0].quantity->unit, "rad");
  EXPECT_EQ(members[2].kind, "link");
  EXPECT_EQ(members[3].quantity->maximum, 2.0);
}

}  // namespace
}  // namespace engram::reports
