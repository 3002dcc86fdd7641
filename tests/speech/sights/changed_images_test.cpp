// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/changed_images.h"

#include <gtest/gtest.h>

namespace engram::speech {
namespace {

constexpr int64_t kSide = 32;
constexpr CellGrid kGrid{.channels = 1, .rows = 4, .columns = 4};
constexpr int64_t kRed = 0;
constexpr int64_t kBlue = 1;
using Pixel = std::array<uint8_t, 3>;

/// A square thing in the left half of a grey image, with a white print in its middle.
idf::NdArray image_with(const Pixel& colour) {
  std::vector<uint8_t> pixels;
  for (int64_t y = 0; y < kSide; ++y)
    for (int64_t x = 0; x < kSide; ++x) {
      const bool is_thing = x >= 4 && x < 12 && y >= 12 && y < 20;
      const bool is_print = is_thing && x >= 7 && x < 9;
      const Pixel pixel = is_print ? Pixel{250, 250, 250} : is_thing ? colour : Pixel{90, 90, 90};
      pixels.insert(pixels.end(), pixel.begin(), pixel.end());
    }
  return idf::NdArray::take({kSide, kSide, 3}, std::move(pixels));
}

ImageTruth truth_with(int64_t colour) {
  ImageTruth truth;
  truth.things.push_back({.kind = 0, .where = 1, .colour = colour, .is_in_sight = true});
  truth.things.back().outline = {
      {0.125F, 0.375F}, {0.375F, 0.375F}, {0.375F, 0.625F}, {0.125F, 0.625F}};
  truth.kinds.assign(kGrid.cells(), ImageTruth::kNothing);
  truth.kinds[4] = 0;
  return truth;
}

ColourLooks looks() {
  ColourLooks looks;
  looks.see(image_with({200, 20, 20}), truth_with(kRed));
  looks.see(image_with({20, 40, 190}), truth_with(kBlue));
  return looks;
}

Pixel pixel_at(const idf::NdArray& image, int64_t x, int64_t y) {
  const auto pixels = image.values<uint8_t>();
  const auto at = static_cast<size_t>(3 * (y * kSide + x));
  return {pixels[at], pixels[at + 1], pixels[at + 2]};
}

TEST(ColourLooks, AreMeasuredOnThings) {
  EXPECT_NEAR(looks().look(kRed).hue, 0, 8);
  EXPECT_NEAR(looks().look(kBlue).hue, 233, 8);
  EXPECT_EQ(looks().look(7).saturation, 0);
  EXPECT_EQ(looks().look(TrueSight::kUntold).saturation, 0);
}

TEST(ChangeImage, GivesThingsOtherColoursAndTellsThem) {
  std::mt19937_64 random(1);
  size_t blue = 0;
  size_t mirrored = 0;
  for (int i = 0; i < 40; ++i) {
    const ChangedImage changed = change_image(image_with({200, 20, 20}), truth_with(kRed), kGrid,
                                              looks(), {0, 2, 1}, random);
    const TrueSight& thing = changed.truth.things.front();
    const bool is_mirrored = thing.where == 2;
    EXPECT_EQ(changed.truth.kinds[is_mirrored ? 7 : 4], 0);
    const auto at = [&](int64_t x) {
      return pixel_at(changed.image, is_mirrored ? kSide - 1 - x : x, 15);
    };
    const Pixel side = at(5);
    EXPECT_EQ(thing.colour == kBlue, side[2] > side[0]);
    const Pixel print = at(7);
    EXPECT_LT(std::abs(print[0] - print[2]), 40) << "what is white stays white";
    const Pixel wall = at(20);
    EXPECT_LT(std::abs(wall[0] - wall[2]), 15);
    blue += thing.colour == kBlue ? 1 : 0;
    mirrored += is_mirrored ? 1 : 0;
  }
  EXPECT_GT(blue, 8U);
  EXPECT_GT(mirrored, 8U);
}

TEST(ChangeImage, LeavesTheValueAroundAnImageAsItIs) {
  const idf::Data value(idf::Dict{{"image", idf::Data(image_with({200, 20, 20}))},
                                  {"camera", idf::Data(std::string("left"))}});
  ASSERT_NE(image_in(value), nullptr);
  const idf::Data changed = with_image(value, image_with({20, 40, 190}));
  EXPECT_EQ(*changed.at("camera"), *value.at("camera"));
  EXPECT_EQ(pixel_at(*image_in(changed), 5, 15)[2], 190);
  EXPECT_EQ(image_in(idf::Data(std::string("no image"))), nullptr);
}

}  // namespace
}  // namespace engram::speech
