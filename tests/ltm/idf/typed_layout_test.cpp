// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/layout.h"
#include "tests/ltm/idf/expect_round_trip.h"
#include "tests/ltm/print_values.h"
#include "tests/ltm/random_types.h"

namespace engram::idf {
namespace {

TEST(TypedLayout, SplitsAndJoinsRandomValuesOfItsType) {
  RandomTypes random(13);
  for (int i = 0; i < 5000; ++i) {
    const Type type = random.type(4);
    const Data value = random.value_of(type);
    for (const FreeSizes free_sizes : {FreeSizes::kRemainder, FreeSizes::kOfValue}) {
      const Layout layout = Layout::of(value, type, free_sizes);
      expect_round_trip(layout, value);
      const auto read = Layout::from_data(layout.to_data());
      ASSERT_OK(read);
      EXPECT_EQ(read->members(), layout.members());
    }
  }
}

TEST(TypedLayout, IsTheSameForAllValuesOfAType) {
  RandomTypes random(14);
  for (int i = 0; i < 5000; ++i) {
    const Type type = random.type(4);
    const Layout layout = Layout::of(random.value_of(type), type);
    expect_round_trip(layout, random.value_of(type));
  }
}

TEST(TypedLayout, SplitsValuesThatAreNotOfTheType) {
  RandomTypes random(15);
  for (int i = 0; i < 5000; ++i) {
    const Data value = random.values().value(4);
    expect_round_trip(Layout::of(value, random.type(4)), value);
  }
}

TEST(Layout, TakesKindsFromATypeAndMovesNothing) {
  const Type type = Type::object("Seen", {{"pose", Type::pose()},
                                          {"maybe", Type::pose().optional()},
                                          {"joints", Type::dict(Type::float32())}});
  Data value = default_value(type);
  value.get_if<Dict>()->set("maybe", default_value(Type::pose()));
  value.get_if<Dict>()->set("joints", Dict{{"wrist", 1.0f}});
  const Layout plain = Layout::of(value);
  const Layout refined = plain.with_kinds_of(Layout::of(value, type));
  ASSERT_EQ(refined.members().size(), plain.members().size());
  for (size_t i = 0; i < refined.members().size(); ++i) {
    const TensorMember& member = refined.members()[i];
    EXPECT_EQ(member.path, plain.members()[i].path);
    EXPECT_EQ(member.kind == MemberKind::kOrientation, member.path == "pose/orientation")
        << member.path;
  }
  expect_round_trip(refined, value);
  EXPECT_EQ(plain.with_kinds_of(plain), plain);
}

TEST(Layout, MovesMembersToTheRemainder) {
  RandomTypes random(17);
  size_t moved = 0;
  for (int i = 0; i < 2000; ++i) {
    const Data value = random.values().value(4);
    const Layout layout = Layout::of(value);
    std::vector<std::string> paths;
    for (size_t k = 0; k < layout.members().size(); k += 2)
      paths.push_back(layout.members()[k].path);
    const Layout smaller = layout.with_remainder(paths);
    expect_round_trip(smaller, value);
    for (const TensorMember& member : smaller.members())
      EXPECT_EQ(std::ranges::count(paths, member.path), 0);
    moved += layout.members().size() - smaller.members().size();
  }
  EXPECT_GT(moved, 500u);
}

TEST(TypedLayout, KnowsTheKindsOfItsMembers) {
  const Type type = Type::object("Seen", {{"picture", Type::image(PixelType::kRgb24, 8, 9)},
                                          {"depth", Type::image(PixelType::kDepth32, 8, 9)},
                                          {"near", Type::image(PixelType::kDepth16, 8, 9)},
                                          {"pose", Type::pose()},
                                          {"cloud", Type::point_cloud(PointType::kXyzi, 2)},
                                          {"matrix", Type::matrix(1, 2)},
                                          {"range", Type::pair(Type::int32(), Type::float64())},
                                          {"time", Type::time()},
                                          {"sure", Type::boolean()}});
  const Layout layout = Layout::of(default_value(type), type);
  const auto f32 = ElementType::kFloat32;
  const std::vector<TensorMember> expected{
      {"picture", MemberKind::kImage, ElementType::kUInt8, {8, 9, 3}},
      {"depth", MemberKind::kDepth, f32, {8, 9, 1}},
      {"near", MemberKind::kImage, ElementType::kUInt16, {8, 9, 1}},
      {"pose/position", MemberKind::kPosition, f32, {3}},
      {"pose/orientation", MemberKind::kOrientation, f32, {4}},
      {"cloud", MemberKind::kPointCloud, f32, {2, 4}},
      {"matrix", MemberKind::kArray, f32, {1, 2}},
      {"range/0", MemberKind::kNumber, ElementType::kInt32, {}},
      {"range/1", MemberKind::kNumber, ElementType::kFloat64, {}},
      {"time", MemberKind::kNumber, ElementType::kInt64, {}},
      {"sure", MemberKind::kBool, ElementType::kUInt8, {}}};
  EXPECT_EQ(layout.members(), expected);
}

TEST(TypedLayout, LeavesWhatMayDifferToTheRemainder) {
  const Type type = Type::object("O", {{"maybe", Type::int32().optional()},
                                       {"free", Type::ndarray(ElementType::kInt8, {kFreeSize})},
                                       {"dict", Type::dict(Type::int32())},
                                       {"list", Type::list(Type::int32())},
                                       {"text", Type::string()}});
  const Data value = Dict{{"maybe", 1},
                          {"free", NdArray::take<int8_t>({2}, {1, 2})},
                          {"dict", Dict{{"a", 1}}},
                          {"list", List{1}},
                          {"text", "t"}};
  const Layout layout = Layout::of(value, type);
  EXPECT_TRUE(layout.members().empty());
  const auto parts = layout.split(value);
  ASSERT_OK(parts);
  EXPECT_EQ(parts->remainder.size(), 5u);
  expect_round_trip(layout, default_value(type));
  const Layout fixed = Layout::of(value, type, FreeSizes::kOfValue);
  ASSERT_EQ(fixed.members().size(), 1u);
  EXPECT_EQ(fixed.members()[0].path, "free");
}

TEST(TypedLayout, WalksListsOfFixedSize) {
  const Type type = Type::list(Type::tuple({Type::float32(), Type::string()}), 2);
  const Data value = List{List{1.0f, "a"}, List{2.0f, "b"}};
  const Layout layout = Layout::of(value, type);
  ASSERT_EQ(layout.members().size(), 2u);
  EXPECT_EQ(layout.members()[1].path, "1/0");
  EXPECT_FAILS(layout.split(List{List{1.0f, "a"}}), StatusCode::kInvalidArgument, "list");
  EXPECT_FAILS(layout.split(List{List{1.0f, "a"}, List{"b", 2.0f}}), StatusCode::kInvalidArgument,
               "'1/0'");
}

TEST(TypedLayout, RefusesBrokenSkeletons) {
  EXPECT_FAILS(Layout::from_data("all"), StatusCode::kDataLoss, "layout");
  EXPECT_FAILS(Layout::from_data(List{"list", 5}), StatusCode::kDataLoss, "'0'");
  EXPECT_FAILS(Layout::from_data(List{8, 5}), StatusCode::kDataLoss, "layout");
}

}  // namespace
}  // namespace engram::idf
