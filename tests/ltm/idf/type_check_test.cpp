// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/type_check.h"

#include <cmath>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/print_values.h"
#include "tests/ltm/random_types.h"

namespace engram::idf {
namespace {

/// The only mismatch there is, as text.
std::string only(const Data& value, const Type& type) {
  const auto mismatches = check(value, type);
  EXPECT_EQ(mismatches.size(), 1u) << text_of(mismatches);
  return mismatches.empty() ? "" : mismatches[0].to_string();
}

NdArray floats(std::vector<float> values) {
  const auto size = static_cast<int64_t>(values.size());
  return NdArray::take<float>({size}, std::move(values));
}

TEST(Check, FindsNothingWhereTheValueIsOfItsType) {
  RandomTypes random(3);
  for (int i = 0; i < 5000; ++i) {
    const Type type = random.type(4);
    const auto mismatches = check(random.value_of(type), type);
    EXPECT_TRUE(mismatches.empty()) << to_string(type) << "\n" << text_of(mismatches);
  }
}

TEST(Check, EveryValueIsOfTheTypeItShows) {
  RandomValues random(4);
  for (int i = 0; i < 3000; ++i) {
    const Data value = random.value(5);
    const auto type = type_of(value);
    ASSERT_OK(type);
    EXPECT_TRUE(check(value, *type).empty()) << to_string(*type);
  }
}

TEST(Check, NamesPathFoundAndNeeded) {
  EXPECT_EQ(only(5, Type::string()), "'': found int32 5, needs string");
  EXPECT_EQ(only(List{1, "a"}, Type::list(Type::int32())), "'1': found string 'a', needs int32");
  EXPECT_EQ(only(Dict{{"a/b", 1.5}}, Type::dict(Type::int64())),
            "'a\\/b': found float64 1.5, needs int64");
  EXPECT_EQ(only(None{}, Type::time()), "'': found none, needs int64 (Time)");
  EXPECT_EQ(only(List{1}, Type::pair(Type::int32(), Type::int32())),
            "'': found list of 1, needs list of 2 (Pair)");
  EXPECT_EQ(only(List{1}, Type::list(Type::int32(), 3)), "'': found list of 1, needs list of 3");
  EXPECT_EQ(only(floats({1, 2}), Type::ndarray(ElementType::kFloat32, {kFreeSize, 2})),
            "'': found ndarray float32 [2], needs ndarray float32 [*, 2]");
}

TEST(Check, ReportsEveryMismatch) {
  const Type type = Type::object("O", {{"a", Type::int32()},
                                       {"b", Type::object("I", {{"c", Type::string()}})},
                                       {"gone", Type::boolean()}});
  const auto mismatches = check(Dict{{"b", Dict{{"c", 1}}}, {"extra", 2}, {"a", "text"}}, type);
  EXPECT_EQ(text_of(mismatches),
            "'a': found string 'text', needs int32\n"
            "'b/c': found int32 1, needs string\n"
            "'gone': found nothing, needs bool\n"
            "'extra': found int32 2, needs no such member in dict (Object O)\n");
  EXPECT_FAILS(to_status(mismatches), StatusCode::kInvalidArgument, "'b/c'");
  EXPECT_OK(to_status({}));
}

TEST(Check, TakesMembersInAnyOrder) {
  const Type type = Type::object("O", {{"a", Type::int32()}, {"b", Type::int32()}});
  EXPECT_TRUE(check(Dict{{"b", 1}, {"a", 2}}, type).empty());
}

TEST(Check, WantsTheKeyOfWhatIsAbsent) {
  const Type type = Type::object("O", {{"a", Type::int32().optional()}});
  EXPECT_TRUE(check(Dict{{"a", None{}}}, type).empty());
  EXPECT_TRUE(check(Dict{{"a", 1}}, type).empty());
  EXPECT_EQ(only(Dict{}, type), "'a': found nothing, needs int32");
}

TEST(Check, HoldsNumbersToTheirBounds) {
  const Quantity quantity{.minimum = 0, .maximum = 10};
  EXPECT_TRUE(check(10, Type::int32(quantity)).empty());
  EXPECT_EQ(only(11, Type::int32(quantity)), "'': found int32 11, needs 0..10");
  EXPECT_EQ(only(double{NAN}, Type::float64(quantity)), "'': found float64 nan, needs 0..10");
  EXPECT_EQ(only(-HUGE_VALF, Type::float32({.maximum = 1})), "'': found float32 -inf, needs ..1");
  EXPECT_TRUE(check(double{NAN}, Type::float64()).empty());
  const int64_t exact = (int64_t{1} << 53) + 1;
  EXPECT_FALSE(check(exact, Type::int64({.maximum = 9007199254740992.0})).empty());
}

TEST(Check, HoldsElementsToTheirBounds) {
  const Type type = Type::ndarray(ElementType::kFloat32, {kFreeSize}, {.minimum = 0});
  EXPECT_TRUE(check(floats({0, 1}), type).empty());
  EXPECT_EQ(only(floats({0, -1, 2, NAN}), type),
            "'': found 2 of 4 elements out of bounds, first element 1 = -1, needs 0..");
}

TEST(Check, KnowsTheValuesOfAnEnum) {
  const Type type = Type::int_enum("E", {{"A", 1}});
  EXPECT_TRUE(check(1, type).empty());
  EXPECT_EQ(only(2, type), "'': found int32 2, needs int32 of IntEnum E{A = 1}");
}

TEST(Check, WantsOrientationsOfNormOne) {
  EXPECT_TRUE(check(floats({1.0005f, 0, 0, 0}), Type::orientation()).empty());
  EXPECT_EQ(only(floats({2, 0, 0, 0}), Type::orientation()),
            "'': found a quaternion of norm 2, needs norm 1");
  EXPECT_FALSE(check(floats({NAN, 0, 0, 0}), Type::orientation()).empty());
  EXPECT_TRUE(check(floats({2, 0, 0, 0}), Type::quaternion()).empty());
}

TEST(Check, TakesPosesApart) {
  const Data pose = Dict{{"position", floats({1, 2, 3})}, {"orientation", floats({1, 1, 0, 0})}};
  EXPECT_THAT(only(pose, Type::pose()), ::testing::HasSubstr("'orientation': found a quaternion"));
  EXPECT_EQ(check(pose, Type::pose(ElementType::kFloat64)).size(), 2u);
}

TEST(Check, ShortensLongTextBetweenCharacters) {
  std::string text;
  for (int i = 0; i < 60; ++i) text += "ü";
  EXPECT_EQ(describe("x" + text).substr(0, 11), "string 'xü");
  EXPECT_OK(to_json_text(Data(describe("x" + text))));
}

}  // namespace
}  // namespace engram::idf
