// SPDX-License-Identifier: Apache-2.0
#include "augmentation/recipe.h"

#include "tests/ltm/expect_status.h"

namespace engram::augmentation {
namespace {

TEST(Recipe, ReadsBackItsText) {
  const Recipe recipe{{{"brightness", idf::Dict{{"levels", int64_t{-12}}}},
                       {"render", idf::Dict{{"scene", "kitchen.blend"}, {"sun", 0.5}}}}};
  const auto text = recipe.to_text();
  ASSERT_OK(text);
  EXPECT_EQ(*text, R"({"version":1,"changes":[{"change":"brightness","levels":-12},)"
                   R"({"change":"render","scene":"kitchen.blend","sun":0.5}]})");
  EXPECT_EQ(*Recipe::parse(*text), recipe);
  EXPECT_EQ(*Recipe::from_data(Recipe{}.to_data()), Recipe{});
}

TEST(Recipe, RefusesWhatIsNone) {
  const auto fails = [](const char* text, const char* message) {
    EXPECT_FAILS(Recipe::parse(text), StatusCode::kInvalidArgument, message);
  };
  fails("{", "recipe");
  fails("7", "needs version 1");
  fails(R"({"version":2,"changes":[]})", "needs version 1");
  fails(R"({"version":1})", "needs a list");
  fails(R"({"version":1,"changes":[{"levels":1}]})", "change 0: needs a dict");
}

TEST(Recipe, TellsWhatIsNoWholeNumber) {
  const Change change{"rotate", idf::Dict{{"millidegrees", 1.5}, {"narrow", int32_t{3}}}};
  EXPECT_EQ(*change.integer("narrow"), 3);
  EXPECT_FAILS(change.integer("millidegrees"), StatusCode::kInvalidArgument,
               "change 'rotate': 'millidegrees' is float64, needs a whole number");
  EXPECT_FAILS(change.integer("seed"), StatusCode::kInvalidArgument, "has no 'seed'");
}

}  // namespace
}  // namespace engram::augmentation
