// SPDX-License-Identifier: Apache-2.0
#include "ltm/likeness/image_descriptor.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/likeness/drawn_moments.h"

namespace engram::ltm {
namespace {

double distance(const std::vector<float>& a, const std::vector<float>& b) {
  double square = 0;
  for (size_t i = 0; i < a.size(); ++i) square += std::pow(a[i] - b[i], 2);
  return std::sqrt(square);
}

TEST(ImageDescriptor, HasTheLengthOneAndKnowsWhereEdgesAre) {
  const auto left = describe_image(drawn_image(8, 20, 40));
  ASSERT_OK(left);
  ASSERT_EQ(left->size(), kDescriptorSize);
  EXPECT_NEAR(std::inner_product(left->begin(), left->end(), left->begin(), 0.0), 1, 1e-5);
  const auto near = *describe_image(drawn_image(10, 20, 40));
  const auto far = *describe_image(drawn_image(40, 30, 40));
  EXPECT_LT(distance(*left, near), distance(*left, far) / 2);
}

TEST(ImageDescriptor, HardlyDependsOnTheLight) {
  const auto bright = *describe_image(drawn_image(8, 20, 90));
  const auto dark = *describe_image(drawn_image(8, 20, 30));
  const auto other = *describe_image(drawn_image(30, 30, 90));
  EXPECT_LT(distance(bright, dark), distance(bright, other) / 3);
}

TEST(ImageDescriptor, IsZeroForOneColour) {
  const auto flat =
      describe_image(idf::NdArray::take({32, 32, 3}, std::vector<uint8_t>(32 * 32 * 3, 90)));
  ASSERT_OK(flat);
  for (const float number : *flat) EXPECT_EQ(number, 0);
}

TEST(ImageDescriptor, TakesDepthWithHoles) {
  std::vector<float> depth(40 * 30, 1.0f);
  std::fill(depth.begin(), depth.begin() + 600, 2.0f);
  depth[7] = std::numeric_limits<float>::quiet_NaN();
  depth[8] = std::numeric_limits<float>::infinity();
  const auto found = describe_image(idf::NdArray::take({30, 40, 1}, std::move(depth)));
  ASSERT_OK(found);
  for (const float number : *found) EXPECT_TRUE(std::isfinite(number));
}

TEST(ImageDescriptor, RefusesWhatIsNoImage) {
  EXPECT_FAILS(describe_image(idf::NdArray::take({4, 4, 3}, std::vector<uint8_t>(48))),
               StatusCode::kInvalidArgument, "found an array uint8 [4, 4, 3]");
  EXPECT_FAILS(describe_image(idf::NdArray::take({16, 16}, std::vector<double>(256))),
               StatusCode::kInvalidArgument, "an image was needed");
  EXPECT_FAILS(describe_image(idf::NdArray()), StatusCode::kInvalidArgument, "uint8 [0]");
}

}  // namespace
}  // namespace engram::ltm
