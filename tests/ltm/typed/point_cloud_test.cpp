// SPDX-License-Identifier: Apache-2.0
#include "ltm/typed/point_cloud.h"

#include <gtest/gtest.h>

namespace engram::typed {
namespace {

using Cloud = PointCloud<idf::PointType::kXyzi>;

Cloud::Points two_points() {
  Cloud::Points points(2, 4);
  points << 1, 2, 3, 4, 5, 6, 7, 8;
  return points;
}

TEST(PointCloud, HasTheFieldsThatItsTypeSays) {
  for (int i = 0; i <= static_cast<int>(idf::PointType::kXyzRgbNormal); ++i)
    EXPECT_EQ(fields_of(static_cast<idf::PointType>(i)),
              idf::field_count(static_cast<idf::PointType>(i)));
}

TEST(PointCloud, IsCopiedInNeitherDirection) {
  Cloud::Points points = two_points();
  const float* numbers = points.data();
  const Cloud cloud(std::move(points));
  EXPECT_EQ(cloud.points().data(), numbers);
  const idf::Type type = idf::Type::point_cloud(idf::PointType::kXyzi);
  const idf::Data data = write(cloud, type);
  EXPECT_EQ(data.get<idf::NdArray>().values<float>().data(), numbers);
  Cloud read_back;
  ASSERT_TRUE(read(data, type, read_back));
  EXPECT_EQ(read_back.points().data(), numbers);
  EXPECT_EQ(read_back.points()(1, 3), 8.0f);
  EXPECT_TRUE(equal(cloud, read_back));
}

TEST(PointCloud, RefusesArraysOfOtherFields) {
  EXPECT_FALSE(Cloud::create(filled<float>({2, 3})).ok());
  EXPECT_FALSE(Cloud::create(filled<double>({2, 4})).ok());
  EXPECT_FALSE(Cloud::create(filled<float>({8})).ok());
  EXPECT_TRUE(Cloud::create(filled<float>({0, 4})).ok());
}

TEST(PointCloud, IsReadOnlyWithTheCountThatItsTypeFixes) {
  Cloud cloud;
  const idf::Type type = idf::Type::point_cloud(idf::PointType::kXyzi, 3);
  EXPECT_FALSE(read(filled<float>({2, 4}), type, cloud));
  EXPECT_TRUE(read(filled<float>({3, 4}), type, cloud));
}

}  // namespace
}  // namespace engram::typed
