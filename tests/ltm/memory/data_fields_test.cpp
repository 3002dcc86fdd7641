// SPDX-License-Identifier: Apache-2.0
#include "ltm/memory/data_fields.h"

#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

TEST(DataFields, ReadsMembersOfTheRightKind) {
  const idf::Data data =
      idf::Dict{{"int", 5},     {"long", int64_t{6}}, {"float", 0.5f},      {"double", 0.25},
                {"bool", true}, {"text", "x"},        {"list", idf::List{}}};
  const auto fields = DataFields::of(data, "thing");
  ASSERT_OK(fields);
  EXPECT_EQ(*fields->integer("int"), 5);
  EXPECT_EQ(*fields->integer("long"), 6);
  EXPECT_EQ(to_ns(*fields->time("long")), 6);
  EXPECT_EQ(*fields->instance_index("int"), 5);
  EXPECT_EQ(*fields->number("float"), 0.5);
  EXPECT_EQ(*fields->number("double"), 0.25);
  EXPECT_EQ(*fields->number("int"), 5);
  EXPECT_TRUE(*fields->boolean("bool"));
  EXPECT_EQ(*fields->text("text"), "x");
  EXPECT_TRUE((*fields->list("list"))->empty());
  EXPECT_EQ(*fields->data("text"), data.at("text"));
  EXPECT_TRUE(fields->has("int"));
  EXPECT_FALSE(fields->has("none"));
}

TEST(DataFields, NamesWhatItFoundAndWhatItNeeds) {
  const idf::Data data = idf::Dict{{"bool", true}, {"text", "x"}, {"large", int64_t{1} << 40}};
  const auto fields = *DataFields::of(data, "thing");
  const auto code = StatusCode::kInvalidArgument;
  EXPECT_FAILS(DataFields::of(idf::List{}, "thing"), code, "thing: found list, needs a dict");
  EXPECT_FAILS(fields.data("none"), code, "thing: has no member 'none', needs a value");
  EXPECT_FAILS(fields.integer("text"), code, "thing: member 'text' is string, needs an integer");
  EXPECT_FAILS(fields.number("bool"), code, "needs a number");
  EXPECT_FAILS(fields.boolean("text"), code, "needs a bool");
  EXPECT_FAILS(fields.text("bool"), code, "needs a string");
  EXPECT_FAILS(fields.list("text"), code, "needs a list");
  EXPECT_FAILS(fields.time("none"), code, "needs an integer");
  EXPECT_FAILS(fields.instance_index("large"), code, "no instance index");
}

}  // namespace
}  // namespace engram::ltm
