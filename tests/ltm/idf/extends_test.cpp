// SPDX-License-Identifier: Apache-2.0
#include "ltm/idf/extends.h"

#include "ltm/idf/cast.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/print_values.h"
#include "tests/ltm/random_types.h"

namespace engram::idf {
namespace {

const Type& core() {
  static const Type kCore =
      Type::object("Core", {{"x", Type::float64({.unit = "m", .minimum = 0, .maximum = 9})},
                            {"in", Type::object("Inner", {{"n", Type::int64().optional()}})}});
  return kCore;
}

Type provider(Type x, Type n, std::vector<Member> more = {}) {
  std::vector<Member> members{{"in", Type::object("Mine", {{"n", std::move(n)}})},
                              {"x", std::move(x)}};
  members.insert(members.end(), more.begin(), more.end());
  return Type::object("Provider", std::move(members));
}

TEST(Extends, EveryTypeExtendsItself) {
  RandomTypes random(11);
  for (int i = 0; i < 3000; ++i) {
    const Type type = random.type(4);
    EXPECT_OK(check_extends(type, type));
    EXPECT_OK(check_extends(type, type.optional()));
  }
}

TEST(Extends, AnObjectExtendsItsBase) {
  const Type more = Type::object("More", {{"y", Type::string()}}, core());
  EXPECT_TRUE(extends(more, core()));
  EXPECT_FALSE(extends(core(), more));
}

TEST(Extends, WhatExtendsIsCastWithoutLoss) {
  RandomTypes random(12);
  int pairs = 0;
  for (int i = 0; i < 300000; ++i) {
    const Type from = random.type(2);
    const Type to = random.type(2);
    if (!extends(from, to)) continue;
    ++pairs;
    const CastResult result = cast(random.value_of(from), to);
    for (const CastNote& note : result.notes)
      EXPECT_EQ(note.kind, CastNote::Kind::kUnknown)
          << to_string(from) << " -> " << to_string(to) << ": " << note.to_string();
  }
  EXPECT_GT(pairs, 1000);
}

TEST(Extends, TakesNarrowerAndMoreBoundedMembers) {
  const Quantity inner{.unit = "m", .minimum = 1, .maximum = 2};
  EXPECT_OK(
      check_extends(provider(Type::float32(inner), Type::int32(), {{"y", Type::time()}}), core()));
}

TEST(Extends, NamesThePathOfWhatBreaksIt) {
  const Quantity good{.unit = "m", .minimum = 0, .maximum = 9};
  const auto fails = [](const Type& type, const char* path, const char* part) {
    EXPECT_FAILS(check_extends(type, core()), StatusCode::kInvalidArgument, path);
    EXPECT_FAILS(check_extends(type, core()), StatusCode::kInvalidArgument, part);
  };
  fails(provider(Type::int64(good), Type::int32()), "'x'", "not as wide");
  fails(provider(Type::string(), Type::int32()), "'x'", "another kind");
  fails(provider(Type::float64(good).optional(), Type::int32()), "'x'", "may be absent");
  fails(provider(Type::float64({.unit = "mm", .minimum = 0, .maximum = 9}), Type::int32()), "'x'",
        "another unit");
  fails(provider(Type::float64({.unit = "m", .minimum = 0}), Type::int32()), "'x'", "less bounded");
  fails(provider(Type::float64(good), Type::boolean()), "'in/n'", "another kind");
  fails(Type::object("P", {{"x", Type::float64(good)}}), "'in'", "missing");
}

TEST(Extends, ComparesArraysByElementShapeAndMeaning) {
  const auto any = Type::ndarray(ElementType::kFloat64, {kFreeSize, 3});
  EXPECT_TRUE(extends(Type::matrix(2, 3), any));
  EXPECT_TRUE(extends(Type::point_cloud(PointType::kXyz), any));
  EXPECT_FALSE(extends(any, Type::matrix(kFreeSize, 3, ElementType::kFloat64)));
  EXPECT_FALSE(extends(Type::matrix(2, 4), any));
  EXPECT_FALSE(extends(any, Type::ndarray(ElementType::kFloat64, {2, 3})));
  EXPECT_TRUE(extends(Type::orientation(), Type::quaternion(ElementType::kFloat64)));
  EXPECT_FALSE(extends(Type::quaternion(), Type::orientation()));
  EXPECT_FALSE(extends(Type::point_cloud(PointType::kXyzi), Type::point_cloud(PointType::kXyzl)));
  EXPECT_FALSE(extends(Type::pose(ElementType::kFloat64), Type::pose()));
}

TEST(Extends, ComparesEnumsAndElements) {
  const auto two = Type::int_enum("E", {{"A", 1}, {"B", 2}});
  EXPECT_TRUE(extends(Type::int_enum("F", {{"B", 2}}), two));
  EXPECT_FALSE(extends(two, Type::int_enum("F", {{"B", 2}})));
  EXPECT_FALSE(extends(Type::int_enum("F", {{"C", 2}}), two));
  EXPECT_FAILS(check_extends(Type::list(Type::string()), Type::list(Type::time())),
               StatusCode::kInvalidArgument, "'*'");
  EXPECT_TRUE(extends(Type::list(Type::int32(), 3), Type::list(Type::int64())));
  EXPECT_FALSE(extends(Type::list(Type::int32()), Type::list(Type::int64(), 3)));
  EXPECT_FALSE(extends(Type::tuple({Type::time()}), Type::tuple({})));
}

}  // namespace
}  // namespace engram::idf
