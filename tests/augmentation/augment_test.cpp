// SPDX-License-Identifier: Apache-2.0
#include "augmentation/augment.h"

#include <set>

#include "tests/augmentation/example_scene.h"
#include "tests/ltm/expect_status.h"

namespace engram::augmentation {
namespace {

Recipe one(std::string name, idf::Dict parameters) {
  return {{{std::move(name), std::move(parameters)}}};
}

std::span<const uint8_t> pixels_of(const idf::Data& value, const char* path) {
  return value.at(path)->get<idf::NdArray>().values<uint8_t>();
}

TEST(Augmented, AddsLevelsAndKeepsThemWithinBytes) {
  const idf::Data value = example_value();
  const auto changed =
      augmented(value, nullptr, one("brightness", idf::Dict{{"levels", int64_t{70}}}), {});
  ASSERT_OK(changed);
  const auto before = pixels_of(value, "image");
  const auto after = pixels_of(*changed, "image");
  for (size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(after[i], std::min(255, before[i] + 70)) << i;
}

TEST(Augmented, RecoloursOnlyTheObjectAndKeepsItsLight) {
  const idf::Data value = example_value();
  const Recipe recipe = one("recolour", idf::Dict{{"label", int64_t{3}},
                                                  {"red", int64_t{0}},
                                                  {"green", int64_t{0}},
                                                  {"blue", int64_t{255}},
                                                  {"percent", int64_t{100}}});
  const auto changed = augmented(value, nullptr, recipe, {{"labels"}, {}});
  ASSERT_OK(changed);
  const auto labels = pixels_of(value, "labels");
  const auto before = pixels_of(value, "image");
  const auto after = pixels_of(*changed, "image");
  for (size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == 0) {
      for (size_t c = 0; c < 3; ++c) EXPECT_EQ(after[3 * i + c], before[3 * i + c]);
    } else {
      EXPECT_EQ(after[3 * i], 0);
      EXPECT_EQ(after[3 * i + 2], 255);
    }
  }
  // An object that is not there.
  Recipe other = recipe;
  other.changes.front().parameters.set("label", int64_t{4});
  EXPECT_EQ(*augmented(value, nullptr, other, {{"labels"}, {}}), value);
}

TEST(Augmented, TakesLabelsOfAnotherEntityAndMovesThemAlong) {
  const idf::Data value = idf::Dict{{"image", example_image(32, 48)}};
  const Recipe recipe{
      {{"shift", idf::Dict{{"right_permille", int64_t{250}}, {"down_permille", int64_t{0}}}},
       {"replace", idf::Dict{{"label", int64_t{3}},
                             {"pattern", int64_t{0}},
                             {"size_permille", int64_t{100}},
                             {"shading_percent", int64_t{0}},
                             {"red", int64_t{1}},
                             {"green", int64_t{2}},
                             {"blue", int64_t{3}},
                             {"other_red", int64_t{0}},
                             {"other_green", int64_t{0}},
                             {"other_blue", int64_t{0}}}}}};
  const auto changed = augmented(value, nullptr, recipe, {}, example_labels(32, 48));
  ASSERT_OK(changed);
  const auto after = pixels_of(*changed, "image");
  const idf::NdArray objects = example_labels(32, 48);
  const auto labels = objects.values<uint8_t>();
  for (size_t y = 0; y < 32; ++y)
    for (size_t x = 12; x < 48; ++x) {
      const bool is_object = labels[y * 48 + x - 12] == 3;
      const uint8_t* pixel = &after[3 * (y * 48 + x)];
      EXPECT_EQ(is_object, pixel[0] == 1 && pixel[1] == 2 && pixel[2] == 3) << x << " " << y;
    }
}

TEST(Augmented, TellsWhatItCannotDo) {
  const idf::Data value = example_value();
  const auto fails = [&](const Recipe& recipe, const SceneMembers& members, const char* message) {
    EXPECT_FAILS(augmented(value, nullptr, recipe, members), StatusCode::kInvalidArgument, message);
  };
  Random random(1);
  const std::vector<ChangeChoice> recolour{*parse_change_choice("recolour", 50)};
  fails(draw_recipe(recolour, 3, random), {}, "needs to be told where the object is");
  fails(one("render", {}), {}, "found 'render'");
  fails(one("rotate", idf::Dict{{"millidegrees", int64_t{50'000}}}), {}, "needs -45000 to 45000");
  fails({}, {{"image"}, {}}, "labels 'image': found [32, 48, 3]");
  fails({}, {{"nowhere"}, {}}, "labels 'nowhere': found nothing");
  fails({}, {{}, {"width_m"}}, "points 'width_m': found float64");
  EXPECT_FAILS(augmented(idf::Dict{{"x", 1.0}}, nullptr, {}, {}), StatusCode::kInvalidArgument,
               "found no image");
}

TEST(Recipes, AreDrawnFromWhatWasChosen) {
  const std::vector<ChangeChoice> choices{*parse_change_choice("noise:20", 50),
                                          *parse_change_choice("brightness", 50)};
  EXPECT_EQ(choices[0].strength_percent, 20);
  EXPECT_EQ(choices[1].strength_percent, 50);
  std::set<std::string> seen;
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Recipe recipe = draw_recipe(choices, 0, random);
    ASSERT_FALSE(recipe.changes.empty());
    for (const Change& change : recipe.changes) {
      seen.insert(change.name);
      if (change.name == "noise") {
        EXPECT_LE(*change.integer("sigma_tenths"), 24);
      } else {
        EXPECT_LE(std::abs(*change.integer("levels")), 32);
      }
    }
  }
  EXPECT_EQ(seen, (std::set<std::string>{"brightness", "noise"}));
  EXPECT_EQ(usual_changes(50, false).size(), 8u);
  EXPECT_EQ(usual_changes(50, true).size(), 10u);
}

TEST(Recipes, SayWhatAStrengthIs) {
  for (const char* text : {"noise:0", "noise:101", "noise:x", "noise:"})
    EXPECT_FAILS(parse_change_choice(text, 50), StatusCode::kInvalidArgument,
                 "needs a strength of 1 to 100");
  EXPECT_FAILS(parse_change_choice("nose", 50), StatusCode::kInvalidArgument, "found 'nose'");
}

}  // namespace
}  // namespace engram::augmentation
