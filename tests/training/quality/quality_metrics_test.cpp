// SPDX-License-Identifier: Apache-2.0
#include "training/quality/quality_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engram::training {
namespace {

idf::Data image_and_number(uint8_t grey, double number) {
  idf::Dict dict;
  dict.set("image", idf::NdArray::take<uint8_t>({8, 8, 1}, std::vector<uint8_t>(64, grey)));
  dict.set("number", number);
  return dict;
}

TEST(Psnr, IsWhatItsDefinitionSays) {
  EXPECT_NEAR(psnr_db(1.0), 48.1308, 1e-4);
  EXPECT_NEAR(psnr_db(65025.0), 0.0, 1e-12);
  EXPECT_EQ(psnr_db(0.0), 60.0);
  EXPECT_EQ(psnr_db(1e-9), 60.0);
  EXPECT_TRUE(std::isnan(psnr_db(std::nan(""))));
}

TEST(Compare, MeasuresImagesAndNumbersApart) {
  const auto error = compare(image_and_number(10, 1.0), image_and_number(13, 1.5));
  ASSERT_TRUE(error.ok());
  EXPECT_DOUBLE_EQ(error->image_mse, 9.0);
  EXPECT_DOUBLE_EQ(error->number_mse, 0.25);
}

TEST(Compare, KnowsNoErrorOfWhatIsMissing) {
  EXPECT_TRUE(std::isnan(compare(idf::Data(1.0), idf::Data(2.0))->image_mse));
}

TEST(Compare, CountsDepthInGreyLevels) {
  std::vector<uint16_t> depth(64, 0), other(64, 0);
  depth[0] = 5100;  // 255 grey levels: 20 units each
  other[0] = 5000;
  const auto error = compare(idf::NdArray::take<uint16_t>({8, 8, 1}, depth),
                             idf::NdArray::take<uint16_t>({8, 8, 1}, other));
  EXPECT_NEAR(error->image_mse, 25.0 / 64, 1e-12);
}

TEST(Compare, CallsALostNotANumberInfinitelyWrong) {
  EXPECT_EQ(compare(idf::Data(std::nan("")), idf::Data(std::nan("")))->number_mse, 0.0);
  EXPECT_TRUE(std::isinf(compare(idf::Data(std::nan("")), idf::Data(1.0))->number_mse));
}

TEST(Compare, BlamesAPredictionForNoBoolAndNoSign) {
  const auto rotation = [](double sign) {
    return idf::NdArray::take<double>({4}, {sign * 0.6, 0.0, sign * 0.8, 0.0});
  };
  const idf::Data seen = idf::Dict{{"seen", true}, {"x", 1.0}, {"turn", rotation(1)}};
  const idf::Data predicted = idf::Dict{{"seen", false}, {"x", 3.0}, {"turn", rotation(-1)}};
  EXPECT_DOUBLE_EQ(compare_prediction(seen, predicted)->number_mse, 4.0 / 5);
  EXPECT_GT(compare(seen, predicted)->number_mse, 1.0);
}

TEST(Compare, LeavesOutTheMembersThatDoNotCount) {
  const idf::Data seen = idf::Dict{{"mode", int32_t{1}}, {"x", 1.0}};
  const idf::Data predicted = idf::Dict{{"mode", int32_t{7}}, {"x", 3.0}};
  EXPECT_DOUBLE_EQ(compare_prediction(seen, predicted)->number_mse, (36.0 + 4) / 2);
  EXPECT_DOUBLE_EQ(compare_prediction(seen, predicted, {"mode"})->number_mse, 4);
  EXPECT_TRUE(std::isnan(compare_prediction(seen, predicted, {"mode", "x"})->number_mse));
}

TEST(Compare, RejectsAnotherLayout) {
  EXPECT_EQ(compare(idf::Data(1.0), idf::Data("text")).status().code(),
            StatusCode::kInvalidArgument);
}

TEST(PsnrStatistics, KeepsBothConventionsApart) {
  PsnrStatistics statistics;
  statistics.add(1.0);    // 48.1308 dB
  statistics.add(100.0);  // 28.1308 dB
  EXPECT_NEAR(statistics.mean_db(), 38.1308, 1e-4);
  EXPECT_NEAR(statistics.pooled_db(), 31.0980, 1e-3);  // of an error of 50.5
  EXPECT_NEAR(statistics.minimum_db(), 28.1308, 1e-4);
  EXPECT_NEAR(statistics.quantile_db(0.05), 29.1308, 1e-4);
  EXPECT_EQ(statistics.capped(), 0u);
}

TEST(PsnrStatistics, CountsWhatItCapped) {
  PsnrStatistics statistics;
  statistics.add(0.0);
  statistics.add(4.0);
  statistics.add(std::nan(""));
  EXPECT_EQ(statistics.count(), 2u);
  EXPECT_EQ(statistics.capped(), 1u);
}

TEST(PsnrStatistics, IsNotANumberWithoutImages) {
  EXPECT_TRUE(std::isnan(PsnrStatistics().mean_db()));
  EXPECT_TRUE(std::isnan(PsnrStatistics().pooled_db()));
  EXPECT_TRUE(std::isnan(PsnrStatistics().quantile_db(0.5)));
}

TEST(RmseStatistics, IsTheRootOfTheMean) {
  RmseStatistics statistics;
  statistics.add(9.0);
  statistics.add(16.0);
  EXPECT_NEAR(statistics.rmse(), std::sqrt(12.5), 1e-12);
  EXPECT_TRUE(std::isnan(RmseStatistics().rmse()));
}

}  // namespace
}  // namespace engram::training
