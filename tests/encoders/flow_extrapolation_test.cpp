// SPDX-License-Identifier: Apache-2.0
#include "encoders/flow_extrapolation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engram::encoders {
namespace {

constexpr int kHeight = 96, kWidth = 112;

/// A smooth pattern without repetition, moved by (x, y) pixels.
template <typename T>
idf::NdArray pattern(int channels, double x, double y, double brightness = 100) {
  std::vector<T> values;
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column)
      for (int c = 0; c < channels; ++c) {
        const double u = column - x;
        const double v = row - y;
        const double wave = std::sin(u * 0.31 + c) * std::cos(v * 0.23) +
                            0.7 * std::sin(u * 0.071 * v * 0.05 + 0.13 * v + 2 * c);
        values.push_back(static_cast<T>(brightness * (1.25 + 0.6 * wave)));
      }
  return idf::NdArray::take<T>({kHeight, kWidth, channels}, std::move(values));
}

/// Mean absolute difference where nothing comes in from outside.
template <typename T>
double difference(const idf::NdArray& a, const idf::NdArray& b, int border) {
  const auto left = a.values<T>();
  const auto right = b.values<T>();
  const auto channels = static_cast<size_t>(a.shape()[2]);
  double sum = 0, count = 0;
  for (int row = border; row < kHeight - border; ++row)
    for (int column = border; column < kWidth - border; ++column)
      for (size_t c = 0; c < channels; ++c) {
        const size_t i = static_cast<size_t>(row * kWidth + column) * channels + c;
        sum += std::abs(static_cast<double>(left[i]) - static_cast<double>(right[i]));
        count += 1;
      }
  return sum / count;
}

template <typename T>
void expect_that_a_moving_pattern_moves_on(int channels, double brightness) {
  const auto before = pattern<T>(channels, 0, 0, brightness);
  const auto last = pattern<T>(channels, 2, -3, brightness);
  const auto next = flow_extrapolated(before, last, 2);
  ASSERT_TRUE(next.ok()) << next.status().to_string();
  ASSERT_EQ(next->size(), 2u);
  for (int ahead = 1; ahead <= 2; ++ahead) {
    const auto& found = (*next)[static_cast<size_t>(ahead - 1)];
    const auto truth = pattern<T>(channels, 2 + 2 * ahead, -3 - 3 * ahead, brightness);
    EXPECT_EQ(found.shape(), last.shape());
    const double copied = difference<T>(last, truth, 16);
    EXPECT_LT(difference<T>(found, truth, 16), 0.15 * copied) << ahead;
  }
}

TEST(FlowExtrapolation, MovesAPatternOn) {
  expect_that_a_moving_pattern_moves_on<uint8_t>(3, 100);
  expect_that_a_moving_pattern_moves_on<uint8_t>(1, 100);
}

TEST(FlowExtrapolation, MovesDepthOn) {
  expect_that_a_moving_pattern_moves_on<uint16_t>(1, 2000);
}

TEST(FlowExtrapolation, KeepsWhatStandsStill) {
  const auto image = pattern<uint8_t>(3, 0, 0);
  const auto next = flow_extrapolated(image, image, 2);
  ASSERT_TRUE(next.ok()) << next.status().to_string();
  for (const auto& found : *next) EXPECT_LT(difference<uint8_t>(found, image, 0), 0.5);
}

TEST(FlowExtrapolation, CopiesImagesThatAreTooSmallForFlow) {
  const auto before = idf::NdArray::take<uint8_t>({8, 8, 1}, std::vector<uint8_t>(64, 3));
  const auto last = idf::NdArray::take<uint8_t>({8, 8, 1}, std::vector<uint8_t>(64, 9));
  const auto next = flow_extrapolated(before, last, 1);
  ASSERT_TRUE(next.ok()) << next.status().to_string();
  EXPECT_EQ(next->front(), last);
}

TEST(FlowExtrapolation, NeedsTwoImagesAlike) {
  const auto image = pattern<uint8_t>(3, 0, 0);
  const auto code = [&](const idf::NdArray& before, const idf::NdArray& last) {
    return flow_extrapolated(before, last, 1).status().code();
  };
  EXPECT_EQ(code(pattern<uint8_t>(1, 0, 0), image), StatusCode::kInvalidArgument);
  EXPECT_EQ(code(image, pattern<uint16_t>(3, 0, 0)), StatusCode::kInvalidArgument);
  const auto row = idf::NdArray::take<uint8_t>({4}, {1, 2, 3, 4});
  EXPECT_EQ(code(row, row), StatusCode::kInvalidArgument);
  const auto floats = idf::NdArray::take<float>({2, 2}, {1, 2, 3, 4});
  EXPECT_EQ(code(floats, floats), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace engram::encoders
