// SPDX-License-Identifier: Apache-2.0
#include "encoders/network_shape.h"

#include <gtest/gtest.h>

namespace engram::encoders {
namespace {

NetworkShape shape_of(int64_t height, int64_t width) {
  idf::Dict dict;
  dict.set("image",
           idf::NdArray::take<uint8_t>(
               {height, width, 3}, std::vector<uint8_t>(static_cast<size_t>(height * width * 3))));
  return network_shape(*TensorPlan::create(idf::Layout::of(idf::Data(dict))), {});
}

TEST(NetworkShape, PadsImagesToWholePlaces) {
  const NetworkShape shape = shape_of(40, 48);
  EXPECT_EQ(shape.images[0].height, 48);
  EXPECT_EQ(shape.images[0].width, 48);
  EXPECT_EQ(shape.grids(0), (std::vector<LatentGrid>{{24, 3, 3}, {8, 6, 6}}));
}

TEST(NetworkShape, SeesLargeImagesInLargerUnits) {
  EXPECT_EQ(shape_of(128, 256).images[0].unit, 1);
  const NetworkShape shape = shape_of(480, 640);
  EXPECT_EQ(shape.images[0].unit, 4);
  EXPECT_EQ(shape.images[0].height, 512);
  EXPECT_EQ(shape.images[0].width, 640);
  EXPECT_EQ(shape.grids(0), (std::vector<LatentGrid>{{24, 8, 10}, {8, 16, 20}}));
}

TEST(NetworkShape, LimitsBackgroundsOfLargeImages) {
  EXPECT_EQ(max_scenes({3, 128, 128, 1}), NetworkSizes::kMaxScenes);
  EXPECT_EQ(max_scenes({3, 2048, 2048, 8}), 5);
  EXPECT_EQ(max_scenes({3, 4096, 4096, 16}), 1);
}

TEST(NetworkShape, RefusesSizesThatCannotBe) {
  EXPECT_TRUE(NetworkSizes{}.is_valid());
  EXPECT_FALSE((NetworkSizes{24, 24, 4, 1}).is_valid());
  EXPECT_TRUE((NetworkSizes{0, 24, 4, 1}).is_valid());
  EXPECT_FALSE((NetworkSizes{-16, 24, 4, 1}).is_valid());
  EXPECT_FALSE((NetworkSizes{64, 0, 4, 1}).is_valid());
  EXPECT_FALSE((NetworkSizes{64, 24, 257, 1}).is_valid());
  EXPECT_FALSE((NetworkSizes{64, 24, 4, 65}).is_valid());
}

}  // namespace
}  // namespace engram::encoders
