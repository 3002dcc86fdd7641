// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/weight_coder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/ltm/expect_status.h"

namespace engram::encoders {
namespace {

/// Normal weights whose deviation is another one in each column.
std::vector<int8_t> some_weights(size_t rows, size_t columns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<int8_t> weights(rows * columns);
  for (size_t i = 0; i < weights.size(); ++i) {
    const double deviation = 4.0 + 24.0 * static_cast<double>(i % columns % 3);
    weights[i] =
        static_cast<int8_t>(std::clamp(std::round(normal(random) * deviation), -127.0, 127.0));
  }
  return weights;
}

/// Bits of a normal distribution that is rounded to integers.
double normal_bits(double deviation) {
  return std::log2(deviation * std::sqrt(2 * 3.14159265358979 * 2.71828182845905));
}

TEST(WeightCoder, GivesBackEveryMatrixInItsOrder) {
  const std::vector<std::vector<int8_t>> matrices{some_weights(16, 27, 1),
                                                  some_weights(1, 5, 2),
                                                  {},
                                                  std::vector<int8_t>(60, 0),
                                                  {-128, 127, -127, 0, 1, -1, -128, 64}};
  const std::vector<size_t> columns{27, 5, 3, 6, 2};
  WeightCoder encoder, decoder;
  for (size_t i = 0; i < matrices.size(); ++i) {
    const auto bytes = encoder.encode(matrices[i], columns[i]);
    const auto read = decoder.decode(bytes, matrices[i].size() / columns[i], columns[i], "matrix");
    ASSERT_OK(read);
    EXPECT_EQ(*read, matrices[i]) << i;
  }
}

TEST(WeightCoder, ComesCloseToTheEntropyOfColumns) {
  const auto weights = some_weights(400, 90, 3);
  const double ideal = (normal_bits(4) + normal_bits(28) + normal_bits(52)) / 3 / 8;
  const auto size = static_cast<double>(WeightCoder().encode(weights, 90).size());
  EXPECT_LT(size, 1.03 * ideal * 400 * 90);
  EXPECT_GT(size, 0.97 * ideal * 400 * 90) << "the widest deviation is cut a little";
}

TEST(WeightCoder, FindsDamageAndAnotherShape) {
  const auto weights = some_weights(6, 8, 4);
  const auto bytes = WeightCoder().encode(weights, 8);
  for (size_t byte = 0; byte < bytes.size(); ++byte) {
    auto damaged = bytes;
    damaged[byte] ^= std::byte{32};
    EXPECT_FAILS(WeightCoder().decode(damaged, 6, 8, "'stem.weight'"), StatusCode::kDataLoss,
                 "'stem.weight'");
  }
  EXPECT_FALSE(WeightCoder().decode(bytes, 8, 6, "turned").ok());
  EXPECT_FALSE(WeightCoder().decode({}, 6, 8, "nothing").ok());
}

}  // namespace
}  // namespace engram::encoders
