// SPDX-License-Identifier: Apache-2.0
#include "viewer/shown_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace engram::viewer {
namespace {

TEST(ShownCloud, LiesWhereThePixelsOfADepthImageLook) {
  std::vector<uint16_t> depth(8 * 10, 0);
  depth[0] = 2000;           // Row 0, column 0.
  depth[3 * 10 + 7] = 1000;  // Row 3, column 7.
  const auto image = idf::NdArray::take<uint16_t>({8, 10, 1}, depth);
  const ShownCloud cloud =
      cloud_of_depth(image, {.fx = 5, .fy = 4, .cx = 4.5, .cy = 3.5}, 0.001, 100);
  EXPECT_EQ(cloud.known, 2u);
  EXPECT_EQ(cloud.points, (std::vector<float>{-1.8f, -1.75f, 2, 0.5f, -0.125f, 1}));
}

TEST(ShownCloud, HasNoPointWhereNothingIsKnown) {
  std::vector<float> depth(64, std::nanf(""));
  depth[1] = std::numeric_limits<float>::infinity();
  depth[2] = -1;
  depth[3] = 0;
  const DepthCamera camera{.fx = 1, .fy = 1};
  const ShownCloud none =
      cloud_of_depth(idf::NdArray::take<float>({8, 8, 1}, depth), camera, 1, 100);
  EXPECT_EQ(none.known, 0u);
  EXPECT_TRUE(none.points.empty());
  depth[9] = 1.5f;
  EXPECT_EQ(cloud_of_depth(idf::NdArray::take<float>({8, 8, 1}, depth), camera, 1, 100).points,
            (std::vector<float>{1.5f, 1.5f, 1.5f}));
}

TEST(ShownCloud, KeepsAnEvenPartOfManyPoints) {
  std::vector<double> rows;
  for (int i = 0; i < 1000; ++i)
    for (const double number : {1.0 * i, 0.0, 0.0, 9.0}) rows.push_back(number);
  rows[4] = std::nan("");  // The second point has no place.
  const ShownCloud cloud = cloud_of_rows(idf::NdArray::take<double>({1000, 4}, rows), 100);
  EXPECT_EQ(cloud.known, 999u);
  ASSERT_EQ(cloud.points.size(), 300u);
  for (size_t i = 3; i < cloud.points.size(); i += 3)
    EXPECT_NEAR(cloud.points[i] - cloud.points[i - 3], 10, 1) << i;
  EXPECT_EQ(cloud_of_rows(idf::NdArray::take<double>({1000, 4}, rows), 5000).points.size(),
            3u * 999);
}

TEST(ShownCloud, TakesRowsOfAnyNumbers) {
  EXPECT_EQ(cloud_of_rows(idf::NdArray::take<int32_t>({1, 3}, {1, -2, 3}), 10).points,
            (std::vector<float>{1, -2, 3}));
}

}  // namespace
}  // namespace engram::viewer
