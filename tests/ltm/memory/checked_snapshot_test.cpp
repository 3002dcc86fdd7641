// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/checked_snapshot.h"

#include <type_traits>

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

using idf::Data;
using idf::Type;

// Nobody comes by one but through the check, or by one that can be changed.
static_assert(!std::is_default_constructible_v<CheckedSnapshot>);
static_assert(!std::is_constructible_v<CheckedSnapshot, Snapshot>);
static_assert(!std::is_constructible_v<CheckedSnapshot::Proof, Snapshot, std::optional<Type>>);
static_assert(!std::is_copy_constructible_v<CheckedSnapshot>);
static_assert(!std::is_move_constructible_v<CheckedSnapshot>);
static_assert(!std::is_copy_assignable_v<CheckedSnapshot>);

MemoryId id(const char* text) {
  return *MemoryId::parse(text);
}

Snapshot snapshot(Data value) {
  return {id("A/b/c/d"), time_from_ns(1), {{std::move(value), {}}}};
}

SegmentTypes types_of(const Type& type) {
  SegmentTypes types;
  EXPECT_OK(types.declare(id("A/b"), type));
  return types;
}

TEST(CheckedSnapshot, IsNotMadeOfAWrongValue) {
  EXPECT_FAILS(CheckedSnapshot::check(snapshot("a text"), types_of(Type::float64())),
               StatusCode::kInvalidArgument, "'A/b/c/d' is not of its segment's type");
}

TEST(CheckedSnapshot, HasTheValueAsItsTypeWantsIt) {
  const auto exact = CheckedSnapshot::check(snapshot(0.1), types_of(Type::float64()));
  ASSERT_OK(exact);
  EXPECT_FALSE(exact->cast.is_cast);
  EXPECT_EQ(exact->snapshot->instances[0].data, Data(0.1));
  const auto widened = CheckedSnapshot::check(snapshot(int32_t{3}), types_of(Type::float64()));
  ASSERT_OK(widened);
  EXPECT_TRUE(widened->cast.is_cast);
  EXPECT_TRUE(widened->cast.notes.empty()) << "it lost nothing";
  EXPECT_EQ(widened->snapshot->instances[0].data, Data(3.0));
  const auto rounded = CheckedSnapshot::check(snapshot(0.1), types_of(Type::float32()));
  ASSERT_OK(rounded);
  EXPECT_EQ(rounded->cast.notes.size(), 1u);
  EXPECT_EQ(rounded->snapshot->instances[0].data, Data(0.1f));
}

TEST(CheckedSnapshot, SaysWhetherItsTypeIsStillTheOne) {
  SegmentTypes types;
  const auto before = CheckedSnapshot::check(snapshot(0.5), types);
  ASSERT_OK(before);
  EXPECT_TRUE(before->snapshot->is_of(types));
  EXPECT_TRUE(before->snapshot->is_of({}));

  ASSERT_OK(types.declare(id("A/b"), Type::float64()));
  EXPECT_FALSE(before->snapshot->is_of(types)) << "there was no type";
  const auto after = CheckedSnapshot::check(snapshot(0.5), types);
  ASSERT_OK(after);
  EXPECT_TRUE(after->snapshot->is_of(types));
  EXPECT_TRUE(after->snapshot->is_of(types_of(Type::float64()))) << "the same, declared elsewhere";
  EXPECT_FALSE(after->snapshot->is_of(types_of(Type::float32())));

  ASSERT_OK(types.declare(id("A/b"), Type::float64({"m", 0, 1})));
  EXPECT_FALSE(after->snapshot->is_of(types)) << "another one was declared";
}

}  // namespace
}  // namespace engram::ltm
