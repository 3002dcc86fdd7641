// SPDX-License-Identifier: Apache-2.0
#include "training/measure/similarity.h"

#include <gtest/gtest.h>

#include "tests/training/moving_scene.h"

namespace engram::training {
namespace {

using engram::testing::scene_at;

/// Codes of values 0..count: the place of the square, whose images repeat after 18, or a constant.
std::vector<std::vector<float>> codes_of(int count, bool knows_place) {
  std::vector<std::vector<float>> codes;
  for (int i = 0; i < count; ++i)
    codes.push_back({knows_place ? static_cast<float>(i % 18) : 0.0F, 1.0F});
  return codes;
}

Result<SimilaritySums> measure(std::span<const std::vector<float>> codes, const Sequence& asking) {
  return measure_similarity(
      codes, asking,
      [](size_t i) -> Result<idf::Data> { return scene_at(static_cast<int>(i), true, false); }, {});
}

TEST(Similarity, FindsTheNearestByPixelsWhereCodesKnowThePlace) {
  const auto sums = measure(codes_of(36, true), {18, 36});
  ASSERT_TRUE(sums.ok()) << sums.status().to_string();
  const SimilarityQuality quality = sums->quality();
  EXPECT_EQ(quality.snapshots, 18u);
  EXPECT_EQ(quality.others, 35u);
  EXPECT_EQ(quality.mean_rank, 1.0);
  // The same image of the other recording is nearer than the one before or after.
  EXPECT_EQ(quality.neighbour_share, 0.0);
  EXPECT_EQ(quality.pixel_neighbour_share, 0.0);
}

TEST(Similarity, CountsNeighboursInTimeOfOneRecording) {
  const auto sums = measure(codes_of(18, true), {0, 18});
  ASSERT_TRUE(sums.ok()) << sums.status().to_string();
  EXPECT_EQ(sums->quality().neighbour_share, 1.0);
  EXPECT_EQ(sums->quality().pixel_neighbour_share, 1.0);
}

TEST(Similarity, IsPoorWhereCodesKnowNothing) {
  const auto sums = measure(codes_of(36, false), {18, 36});
  ASSERT_TRUE(sums.ok()) << sums.status().to_string();
  EXPECT_GT(sums->quality().mean_rank, 5.0);
}

TEST(Similarity, HasNothingToMeasureWithoutCodes) {
  const auto sums = measure(std::vector<std::vector<float>>{}, {0, 0});
  ASSERT_TRUE(sums.ok());
  EXPECT_EQ(sums->quality().snapshots, 0u);
}

}  // namespace
}  // namespace engram::training
