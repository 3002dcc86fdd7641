// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/measure.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "ltm/filter/reduced_image.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

idf::NdArray numbers(std::vector<double> values) {
  const auto count = static_cast<int64_t>(values.size());
  return idf::NdArray::take<double>({count}, std::move(values));
}

double measured(Measure measure, std::vector<double> a, std::vector<double> b) {
  NumberDifference difference;
  difference.add(numbers(std::move(a)), numbers(std::move(b)));
  return difference.measured(measure);
}

TEST(Measure, KnowsItsNames) {
  for (int i = 0; i <= static_cast<int>(Measure::kCosine); ++i) {
    const auto measure = static_cast<Measure>(i);
    EXPECT_EQ(measure_from_name(to_string(measure)), measure);
  }
  EXPECT_FALSE(measure_from_name("psnr").has_value());
}

TEST(Measure, ComputesWhatItsNameSays) {
  EXPECT_DOUBLE_EQ(measured(Measure::kMse, {0, 0}, {3, 1}), 5);
  EXPECT_DOUBLE_EQ(measured(Measure::kMae, {0, 0}, {3, -1}), 2);
  EXPECT_DOUBLE_EQ(measured(Measure::kMaxAbs, {0, 0}, {3, -4}), 4);
  EXPECT_DOUBLE_EQ(measured(Measure::kRms, {0, 0}, {3, 4}), std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(measured(Measure::kCosine, {1, 0}, {1, 1}), std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(measured(Measure::kCosine, {0, 0}, {0, 0}), 1);
  EXPECT_TRUE(std::isnan(measured(Measure::kCosine, {0, 0}, {0, 1})));
}

TEST(Measure, TakesNanForNanAndForNothingElse) {
  EXPECT_EQ(measured(Measure::kMaxAbs, {kNan, kInf, 1}, {kNan, kInf, 1}), 0);
  EXPECT_TRUE(std::isnan(measured(Measure::kMaxAbs, {kNan}, {1})));
  EXPECT_TRUE(std::isnan(measured(Measure::kRms, {kInf}, {-kInf})));
  EXPECT_FALSE((Similarity{Measure::kMaxAbs, kInf}.admits(kNan)));
  EXPECT_FALSE((Similarity{Measure::kSsim, -1}.admits(kNan)));
}

TEST(Measure, IsExactForLargeIntegers) {
  NumberDifference difference;
  const int64_t large = int64_t{1} << 62;
  difference.add(idf::NdArray::take<int64_t>({2}, {large, INT64_MIN}),
                 idf::NdArray::take<int64_t>({2}, {large + 1, INT64_MIN}));
  EXPECT_EQ(difference.measured(Measure::kMaxAbs), 1);
  difference.add(idf::NdArray::take<uint8_t>({1}, {0}), idf::NdArray::take<uint8_t>({1}, {255}));
  EXPECT_EQ(difference.measured(Measure::kMaxAbs), 255);
}

TEST(Measure, GivesTheAngleOfRotations) {
  const auto about_x = [](double angle, double sign) {
    return numbers({sign * std::cos(angle / 2), sign * std::sin(angle / 2), 0, 0});
  };
  EXPECT_NEAR(rotation_angle_rad(about_x(0, 1), about_x(1e-7, 1)), 1e-7, 1e-12);
  EXPECT_NEAR(rotation_angle_rad(about_x(0.2, 1), about_x(0.5, -1)), 0.3, 1e-12);
  EXPECT_NEAR(rotation_angle_rad(about_x(0, 1), about_x(std::numbers::pi, 1)), std::numbers::pi,
              1e-12);
  EXPECT_TRUE(std::isnan(rotation_angle_rad(numbers({0, 0, 0, 0}), about_x(0, 1))));
  EXPECT_TRUE(std::isnan(rotation_angle_rad(numbers({1, 0}), numbers({1, 0}))));
}

TEST(Similarity, RefusesBoundsThatNothingMeets) {
  EXPECT_OK((Similarity{Measure::kSsim, 0.9}.validate()));
  EXPECT_FAILS((Similarity{Measure::kSsim, 1.5}.validate()), StatusCode::kInvalidArgument,
               "needs -1 to 1");
  EXPECT_FAILS((Similarity{Measure::kRms, -0.1}.validate()), StatusCode::kInvalidArgument,
               "from 0 on");
  EXPECT_FAILS((Similarity{Measure::kMse, kNan}.validate()), StatusCode::kInvalidArgument, "nan");
  EXPECT_OK((Similarity{Measure::kEqual, kNan}.validate()));
}

template <typename T>
idf::NdArray gradient(int64_t height, int64_t width, int64_t channels, double offset) {
  std::vector<T> values;
  for (int64_t i = 0; i < height * width * channels; ++i)
    values.push_back(static_cast<T>(
        static_cast<double>(i / channels % width) * 100 / static_cast<double>(width) + offset));
  return idf::NdArray::take<T>({height, width, channels}, std::move(values));
}

TEST(ReducedImage, MeasuresWhatDiffers) {
  const auto a = ReducedImage::of(gradient<uint8_t>(480, 640, 3, 0));
  const auto b = ReducedImage::of(gradient<uint8_t>(480, 640, 3, 10));
  ASSERT_TRUE(a && b);
  EXPECT_DOUBLE_EQ(a->measured(Measure::kMse, *a), 0);
  EXPECT_DOUBLE_EQ(a->measured(Measure::kSsim, *a), 1);
  EXPECT_NEAR(a->measured(Measure::kMse, *b), 100, 1);
  EXPECT_NEAR(a->measured(Measure::kMae, *b), 10, 0.1);
  EXPECT_LT(a->measured(Measure::kSsim, *b), 0.999);
  EXPECT_GT(a->measured(Measure::kSsim, *b), 0.5);
}

TEST(ReducedImage, FindsStructureThatIsGone) {
  std::vector<uint8_t> stripes(64 * 64), grey(64 * 64, 128);
  for (size_t i = 0; i < stripes.size(); ++i) stripes[i] = i / 2 % 2 == 0 ? 0 : 255;
  const auto a = ReducedImage::of(idf::NdArray::take<uint8_t>({64, 64, 1}, stripes));
  const auto b = ReducedImage::of(idf::NdArray::take<uint8_t>({64, 64, 1}, grey));
  EXPECT_LT(a->measured(Measure::kSsim, *b), 0.05);
}

TEST(ReducedImage, TakesImagesOfAnySizeAndType) {
  EXPECT_TRUE(ReducedImage::of(gradient<uint16_t>(9, 1000, 1, 0)));
  EXPECT_TRUE(ReducedImage::of(gradient<double>(3, 2, 1, 0)));
  EXPECT_TRUE(ReducedImage::of(gradient<float>(1, 1, 4, 0)));
  const auto holes = ReducedImage::of(idf::NdArray::take<float>({2, 2}, {1, NAN, INFINITY, 2}));
  ASSERT_TRUE(holes);
  EXPECT_DOUBLE_EQ(holes->measured(Measure::kMse, *holes), 0);
}

TEST(ReducedImage, IsNothingOfWhatIsNoImage) {
  EXPECT_FALSE(ReducedImage::of(idf::NdArray::take<uint8_t>({0, 8, 3}, {})));
  EXPECT_FALSE(ReducedImage::of(idf::NdArray::take<uint8_t>({8}, std::vector<uint8_t>(8))));
  EXPECT_FALSE(ReducedImage::of(idf::NdArray::take<uint8_t>({1, 1, 5}, std::vector<uint8_t>(5))));
  EXPECT_FALSE(ReducedImage::of(idf::NdArray::take<int32_t>({2, 2}, std::vector<int32_t>(4))));
}

}  // namespace
}  // namespace engram::ltm
