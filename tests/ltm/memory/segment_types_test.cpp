// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/segment_types.h"

#include "ltm/idf/type_check.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

using idf::Data;
using idf::Dict;
using idf::Type;

MemoryId id(const char* text) {
  return *MemoryId::parse(text);
}

Type thing() {
  return Type::object("Thing", {{"name", Type::string()}, {"height", Type::float32({"m", 0, 2})}});
}

Type cup() {
  return Type::object("Cup", {{"fill", Type::float32()}}, thing());
}

SegmentTypes declared() {
  SegmentTypes types;
  EXPECT_OK(types.declare(id("Objects/Things"), thing()));
  EXPECT_OK(types.declare(id("Objects/Things/cups"), cup()));
  return types;
}

Data value(float height) {
  return Dict{{"name", "mug"}, {"height", height}};
}

TEST(SegmentTypes, GivesAnEntityTheTypeOfItsProviderElseOfItsCore) {
  const SegmentTypes types = declared();
  EXPECT_EQ(*types.of_entity(id("Objects/Things/cups/blue")), cup());
  EXPECT_EQ(*types.of_entity(id("Objects/Things/cups/blue").at(time_from_ns(5)).instance(0)), cup());
  EXPECT_EQ(*types.of_entity(id("Objects/Things/tables/round")), thing());
  EXPECT_EQ(types.of_entity(id("Objects/Places/rooms/kitchen")), nullptr);
}

TEST(SegmentTypes, RefusesAProviderThatDoesNotExtendItsCore) {
  SegmentTypes types = declared();
  const Type other = Type::object("Other", {{"name", Type::string()}, {"height", Type::string()}});
  EXPECT_FAILS(types.declare(id("Objects/Things/bad"), other), StatusCode::kInvalidArgument,
               "'Objects/Things/bad' must extend core segment 'Objects/Things'");
  EXPECT_FAILS(types.declare(id("Objects/Things/bad"), other), StatusCode::kInvalidArgument,
               "height");
  EXPECT_EQ(types, declared()) << "a refused type changes nothing";
}

TEST(SegmentTypes, RefusesACoreTypeThatAProviderDoesNotExtend) {
  SegmentTypes types = declared();
  EXPECT_FAILS(types.declare(id("Objects/Things"), Type::object("T", {{"mass", Type::float32()}})),
               StatusCode::kInvalidArgument, "'Objects/Things/cups' must extend");
  EXPECT_OK(types.declare(id("Objects/Things"), Type::object("T", {{"name", Type::string()}})));
}

TEST(SegmentTypes, RefusesWhatIsNoSegment) {
  SegmentTypes types;
  for (const char* text : {"Objects", "Objects/Things/cups/blue"})
    EXPECT_FAILS(types.declare(id(text), thing()), StatusCode::kInvalidArgument, text);
}

TEST(SegmentTypes, TakesWhatFitsAsItIs) {
  const auto taken = declared().reinterpret(id("Objects/Things/tables/round"), value(0.5f));
  ASSERT_OK(taken);
  EXPECT_EQ(taken->value, value(0.5f));
  EXPECT_TRUE(taken->notes.empty());
  const auto untyped = declared().reinterpret(id("Any/Thing/at/all"), Data(5.0));
  ASSERT_OK(untyped);
  EXPECT_EQ(untyped->value, Data(5.0));
}

TEST(SegmentTypes, ReadsOtherNumbersAndMoreMembersAsTheCoreType) {
  const SegmentTypes types = declared();
  const Data given = Dict{{"height", 0.1}, {"name", "mug"}, {"colour", "blue"}};
  const auto taken = types.reinterpret(id("Objects/Things/tables/round"), given);
  ASSERT_OK(taken);
  EXPECT_EQ(taken->value, value(0.1f));
  ASSERT_EQ(taken->notes.size(), 2u);
  EXPECT_TRUE(idf::check(taken->value, thing()).empty());
}

TEST(SegmentTypes, RefusesWhatBreaksTheTypeWithEveryPath) {
  const SegmentTypes types = declared();
  const Data broken = Dict{{"name", 5}, {"height", 3.0f}};
  const auto refused = types.reinterpret(id("Objects/Things/cups/blue"), broken);
  EXPECT_FAILS(refused.status(), StatusCode::kInvalidArgument, "Objects/Things/cups/blue");
  for (const char* path : {"name", "height", "fill"})
    EXPECT_FAILS(refused.status(), StatusCode::kInvalidArgument, path);
}

TEST(SegmentTypes, ReadsBackItsData) {
  const SegmentTypes types = declared();
  const auto read = SegmentTypes::from_data(types.to_data());
  ASSERT_OK(read);
  EXPECT_EQ(*read, types);
  EXPECT_FAILS(SegmentTypes::from_data(Data(5)).status(), StatusCode::kDataLoss, "int32");
  EXPECT_FAILS(SegmentTypes::from_data(Dict{{"a/b", "no type"}}).status(), StatusCode::kDataLoss,
               "'a/b'");
}

}  // namespace
}  // namespace engram::ltm
