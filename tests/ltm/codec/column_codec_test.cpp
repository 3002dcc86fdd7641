// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/column_codec.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "ltm/codec/zstd.h"
#include "tests/ltm/codec/test_images.h"
#include "tests/ltm/expect_status.h"

namespace engram::ltm {
namespace {

using idf::ElementType;

template <typename T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

template <typename T>
std::vector<std::byte> expect_round_trip(const std::vector<T>& values) {
  const auto packed = compress_column(idf::kElementTypeOf<T>, bytes_of(values));
  const auto plain = decompress_column(packed, idf::kElementTypeOf<T>, values.size());
  EXPECT_OK(plain);
  if (plain.ok()) {
    EXPECT_TRUE(std::ranges::equal(*plain, bytes_of(values)));
  }
  EXPECT_EQ(compress_column(idf::kElementTypeOf<T>, bytes_of(values)), packed);
  return packed;
}

TEST(ColumnCodec, GivesBackRandomColumnsOfEveryType) {
  RandomValues random(71);
  for (int code = 1; code <= 10; ++code)
    for (const int64_t count : {0, 1, 2, 7, 8, 9, 1000, 40'000}) {
      const ElementType type = *idf::element_type_from_code(static_cast<uint8_t>(code));
      const idf::NdArray column = random_array(type, {count}, random);
      const auto packed = compress_column(type, column.bytes());
      const auto plain = decompress_column(packed, type, static_cast<size_t>(count));
      ASSERT_OK(plain);
      EXPECT_TRUE(std::ranges::equal(*plain, column.bytes()));
    }
}

TEST(ColumnCodec, GivesBackOddFloats) {
  using Limits = std::numeric_limits<double>;
  expect_round_trip<double>({0.0, -0.0, 1.5, Limits::quiet_NaN(), Limits::infinity(),
                             -Limits::infinity(), Limits::denorm_min(), Limits::max(), 0.1, 1e300});
  expect_round_trip<double>({0.0, -0.0});
  expect_round_trip<float>({1.5f, -0.0f, 0.1f, 16777216.0f, 3e9f, 1e-9f});
  expect_round_trip<double>({9007199254740992.0, 9007199254740991.0, 1.0});
}

TEST(ColumnCodec, StoresTimesOfASteadyClockInNoSpace) {
  std::vector<int64_t> times;
  for (int64_t i = 0; i < 10'000; ++i) times.push_back(1'600'000'000'000'000'000 + i * 10'000'000);
  const auto packed = expect_round_trip(times);
  EXPECT_NE(column_scheme(packed)->transform, ColumnTransform::kNone);
  EXPECT_LT(packed.size(), 100u);
}

TEST(ColumnCodec, StoresFloatsOfFewDecimalsAsIntegers) {
  std::vector<double> angles;
  for (int i = 0; i < 5000; ++i) angles.push_back(std::round(1e3 * std::sin(0.01 * i)) / 1e3);
  const auto packed = expect_round_trip(angles);
  EXPECT_EQ(column_scheme(packed)->decimals, 3);
  EXPECT_LT(3 * packed.size(), compress_zstd(bytes_of(angles)).size());
}

TEST(ColumnCodec, TakesLessThanPlainZstdForSmoothFloats) {
  std::vector<float> values;
  for (int i = 0; i < 5000; ++i) values.push_back(std::sin(0.001f * static_cast<float>(i)));
  EXPECT_LT(2 * expect_round_trip(values).size(), compress_zstd(bytes_of(values)).size());
}

TEST(ColumnCodec, NamesItsSchemes) {
  EXPECT_EQ(to_string(ColumnScheme{}), "plain");
  EXPECT_EQ(to_string(ColumnScheme{ColumnTransform::kDeltaDelta, ColumnShuffle::kBits, 3}),
            "delta of delta, bits, 3 decimals");
}

TEST(ColumnCodec, RefusesAnotherTypeOrCount) {
  const std::vector<int32_t> values(100, 7);
  const auto packed = expect_round_trip(values);
  EXPECT_FAILS(decompress_column(packed, ElementType::kInt32, 99), StatusCode::kDataLoss, "");
  EXPECT_FAILS(decompress_column(packed, ElementType::kInt32, 101), StatusCode::kDataLoss, "");
  EXPECT_FAILS(decompress_column(packed, ElementType::kInt64, 100), StatusCode::kDataLoss, "");
  EXPECT_FAILS(decompress_column(packed, ElementType::kInt64, SIZE_MAX), StatusCode::kDataLoss, "");
  EXPECT_FAILS(decompress_column({}, ElementType::kInt64, 0), StatusCode::kDataLoss, "no column");
}

TEST(ColumnCodec, SurvivesTruncationsAndFlips) {
  RandomValues random(72);
  std::vector<double> values;
  for (int i = 0; i < 200; ++i) values.push_back(0.25 * i);
  const auto packed = expect_round_trip(values);
  for (size_t size = 0; size < packed.size(); ++size)
    EXPECT_FAILS(decompress_column({packed.data(), size}, ElementType::kFloat64, 200),
                 StatusCode::kDataLoss, "");
  for (int i = 0; i < 3000; ++i) {
    auto damaged = packed;
    damaged[random.below(damaged.size())] = static_cast<std::byte>(random.bits());
    const auto plain = decompress_column(damaged, ElementType::kFloat64, 200);
    if (plain.ok())
      EXPECT_EQ(plain->size(), 1600u);
    else
      EXPECT_FAILS(plain, StatusCode::kDataLoss, "");
  }
}

}  // namespace
}  // namespace engram::ltm
