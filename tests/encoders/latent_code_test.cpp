// SPDX-License-Identifier: Apache-2.0
#include "encoders/latent_code.h"

#include <gtest/gtest.h>

#include <random>

namespace engram::encoders {
namespace {

const std::vector<LatentGrid> kGrids{{6, 8, 10}, {5, 1, 1}};

std::vector<int32_t> random_values(uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<int32_t> values;
  for (size_t i = 0; i < 485; ++i)
    values.push_back(random() % 4 == 0 ? static_cast<int32_t>(random() % 9) - 4 : 0);
  return values;
}

LatentCoder fitted_coder() {
  LatentStatistics statistics(kGrids);
  for (uint32_t seed = 0; seed < 20; ++seed) statistics.add(random_values(seed));
  return statistics.coder();
}

TEST(LatentCode, GivesBackTheValues) {
  const LatentCoder coder = fitted_coder();
  for (uint32_t seed = 0; seed < 40; ++seed) {
    const auto decoded = coder.decode(coder.encode(random_values(seed)));
    ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
    EXPECT_EQ(*decoded, random_values(seed));
  }
}

TEST(LatentCode, GivesBackValuesThatItNeverCounted) {
  const LatentCoder coder = fitted_coder();
  std::vector<int32_t> values(coder.count(), 100000);
  values[7] = -1000000;
  EXPECT_EQ(*coder.decode(coder.encode(values)), values);
}

TEST(LatentCode, DetectsEveryDamagedByte) {
  const LatentCoder coder = fitted_coder();
  const auto code = coder.encode(random_values(1));
  for (size_t i = 0; i < code.size(); ++i) {
    auto damaged = code;
    damaged[i] ^= std::byte{0x10};
    EXPECT_EQ(coder.decode(damaged).status().code(), StatusCode::kDataLoss) << "byte " << i;
  }
}

TEST(LatentCode, DetectsATruncatedCode) {
  const LatentCoder coder = fitted_coder();
  const auto code = coder.encode(random_values(1));
  for (size_t size = 0; size < code.size(); ++size)
    EXPECT_FALSE(coder.decode(std::span(code).first(size)).ok()) << size << " bytes";
}

TEST(LatentCode, RejectsTooFewTables) {
  EXPECT_EQ(LatentCoder::create(kGrids, {}).status().code(), StatusCode::kDataLoss);
}

}  // namespace
}  // namespace engram::encoders
