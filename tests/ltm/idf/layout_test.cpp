// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/layout.h"

#include "tests/ltm/idf/expect_round_trip.h"
#include "tests/ltm/random_values.h"

namespace engram::idf {
namespace {

NdArray zeros(const Shape& shape) {
  return NdArray::take<uint8_t>(shape,
                                std::vector<uint8_t>(*size_bytes(ElementType::kUInt8, shape)));
}

TEST(Layout, SplitsAndJoinsRandomValues) {
  RandomValues random(8);
  for (int i = 0; i < 3000; ++i) {
    const Data value = random.value(5);
    expect_round_trip(Layout::of(value), value);
  }
}

TEST(Layout, IsAValueItself) {
  RandomValues random(9);
  for (int i = 0; i < 1000; ++i) {
    const Layout layout = Layout::of(random.value(5));
    const auto read = Layout::from_data(layout.to_data());
    ASSERT_OK(read);
    EXPECT_EQ(*read, layout);
    EXPECT_EQ(read->members(), layout.members());
  }
}

TEST(Layout, KnowsItsMembers) {
  const Layout layout = Layout::of(Dict{{"image", zeros({8, 9, 3})},
                                        {"pose", Dict{{"x", 1.0}, {"name", "arm"}, {"ok", true}}},
                                        {"cloud", NdArray::take<float>({1, 3}, {1, 2, 3})},
                                        {"history", List{1, 2}},
                                        {"count", 3}});
  const std::vector<TensorMember> expected{
      {"image", MemberKind::kImage, ElementType::kUInt8, {8, 9, 3}},
      {"pose/x", MemberKind::kNumber, ElementType::kFloat64, {}},
      {"pose/ok", MemberKind::kBool, ElementType::kUInt8, {}},
      {"cloud", MemberKind::kArray, ElementType::kFloat32, {1, 3}},
      {"count", MemberKind::kNumber, ElementType::kInt32, {}}};
  EXPECT_EQ(layout.members(), expected);
}

TEST(Layout, TellsImagesFromArrays) {
  const auto kind = [](const NdArray& array) {
    const Layout layout = Layout::of(array);
    return layout.members()[0].kind;
  };
  EXPECT_EQ(kind(zeros({8, 8, 1})), MemberKind::kImage);
  EXPECT_EQ(kind(NdArray::take<uint16_t>({8, 8, 1}, std::vector<uint16_t>(64))),
            MemberKind::kImage);
  for (const Shape& shape : {Shape{7, 8, 3}, Shape{8, 7, 3}, Shape{8, 8, 2}, Shape{8, 8}})
    EXPECT_EQ(kind(zeros(shape)), MemberKind::kArray) << to_string(shape);
  EXPECT_EQ(kind(NdArray::take<uint16_t>({8, 8, 3}, std::vector<uint16_t>(192))),
            MemberKind::kArray);
}

TEST(Layout, RefusesAValueOfAnotherLayoutWithItsPath) {
  const Layout layout = Layout::of(Dict{{"a", Dict{{"x", 1.0}, {"s", "text"}}}, {"v", zeros({2})}});
  const auto value = [](Data x, Data s, Data v) {
    return Data(Dict{{"a", Dict{{"x", std::move(x)}, {"s", std::move(s)}}}, {"v", std::move(v)}});
  };
  EXPECT_OK(layout.split(value(2.0, List{}, zeros({2}))));
  EXPECT_FAILS(layout.split(value(2.0f, "", zeros({2}))), StatusCode::kInvalidArgument, "'a/x'");
  EXPECT_FAILS(layout.split(value("2", "", zeros({2}))), StatusCode::kInvalidArgument, "'a/x'");
  EXPECT_FAILS(layout.split(value(2.0, 5, zeros({2}))), StatusCode::kInvalidArgument, "'a/s'");
  EXPECT_FAILS(layout.split(value(2.0, Dict{}, zeros({2}))), StatusCode::kInvalidArgument, "'a/s'");
  EXPECT_FAILS(layout.split(value(2.0, "", zeros({3}))), StatusCode::kInvalidArgument, "'v'");
  EXPECT_FAILS(layout.split(Dict{{"a", 1}}), StatusCode::kInvalidArgument, "dict");
  EXPECT_FAILS(layout.split(Dict{{"b", 1}, {"v", 2}}), StatusCode::kInvalidArgument, "'a'");
  EXPECT_FAILS(layout.split(Data(1)), StatusCode::kInvalidArgument, "int32");
}

TEST(Layout, RefusesToJoinWhatIsNotItsOwn) {
  const Data value = Dict{{"x", 1.0}, {"s", "text"}};
  const Layout layout = Layout::of(value);
  const SplitValue parts = *layout.split(value);
  SplitValue fewer = parts, other = parts, longer = parts;
  fewer.tensors.clear();
  other.tensors[0] = NdArray::take<float>({}, {1});
  longer.remainder.emplace_back(5);
  EXPECT_FAILS(layout.join(fewer), StatusCode::kInvalidArgument, "found 0 tensors, needs 1");
  EXPECT_FAILS(layout.join(other), StatusCode::kInvalidArgument, "'x'");
  EXPECT_FAILS(layout.join(longer), StatusCode::kInvalidArgument, "remainder of 2");
}

TEST(Layout, RefusesToReadWhatIsNoLayout) {
  for (const Data& data :
       {Data(5), Data(List{}), Data(List{1}), Data(List{9, 9}), Data(List{0, 0}), Data(List{1, 11}),
        Data(List{2, 5, int64_t{-1}}), Data(List{2, 5, 3}), Data(List{1, 5, int64_t{3}}),
        Data(List{2, 10, INT64_MAX, INT64_MAX}), Data(Dict{{"a", "text"}})})
    EXPECT_FAILS(Layout::from_data(data), StatusCode::kDataLoss, "layout");
}

TEST(Layout, OfNoScalarTypeIsRefused) {
  // A number of type uint16 is none that a value can have.
  EXPECT_FAILS(Layout::from_data(List{1, 6}), StatusCode::kDataLoss, "layout");
  EXPECT_FAILS(Layout::from_data(List{0, 6}), StatusCode::kDataLoss, "layout");
}

TEST(Layout, SurvivesSkeletonsOfRandomValues) {
  RandomValues random(10);
  for (int i = 0; i < 5000; ++i) {
    const auto layout = Layout::from_data(random.value(4));
    if (layout.ok()) (void)layout->split(random.value(3)).ok();
  }
}

}  // namespace
}  // namespace engram::idf
