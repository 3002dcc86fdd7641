// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/integer_coder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>

namespace engram::encoders {
namespace {

constexpr int32_t kLeast = std::numeric_limits<int32_t>::min();
constexpr int32_t kMost = std::numeric_limits<int32_t>::max();

std::vector<int32_t> laplace(size_t count, double scale, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<int32_t> values;
  for (size_t i = 0; i < count; ++i) {
    const double size = -scale * std::log((random() + 1.0) / 4294967297.0);
    values.push_back(static_cast<int32_t>(std::lround(random() % 2 == 0 ? size : -size)));
  }
  return values;
}

/// Of the values as they are counted. Unit: bits.
double entropy(const std::vector<int32_t>& values) {
  std::map<int32_t, double> counts;
  for (const int32_t value : values) counts[value] += 1;
  double bits = 0;
  for (const auto& [value, count] : counts)
    bits -= count * std::log2(count / static_cast<double>(values.size()));
  return bits;
}

void expect_round_trip(const std::vector<int32_t>& values) {
  const auto bytes = encode_integers(values);
  const auto decoded = decode_integers(bytes, values.size());
  ASSERT_TRUE(decoded.ok()) << decoded.status().to_string();
  EXPECT_EQ(*decoded, values);
  EXPECT_EQ(encode_integers(values), bytes);
}

TEST(IntegerCoder, GivesBackWhatItWasGiven) {
  expect_round_trip({});
  expect_round_trip({0});
  expect_round_trip({kLeast, kMost, 0, -1, 1, kLeast, kLeast, kMost});
  expect_round_trip(std::vector<int32_t>(5000, 17));
  expect_round_trip(std::vector<int32_t>(5000, kLeast));
  expect_round_trip(laplace(5000, 40, 3));
  std::mt19937 random(5);
  std::vector<int32_t> anything;
  for (int i = 0; i < 5000; ++i) anything.push_back(static_cast<int32_t>(random()));
  expect_round_trip(anything);
}

TEST(IntegerCoder, CodesAllOf64Bits) {
  const std::array<int64_t, 6> values{INT64_MIN, INT64_MAX, -1, 0, 1, int64_t{1} << 40};
  BinaryEncoder encoder;
  IntegerModel writing;
  for (const int64_t value : values) writing.code(encoder, value);
  const auto bytes = encoder.finish();
  BinaryDecoder decoder(bytes);
  IntegerModel reading;
  for (const int64_t value : values) EXPECT_EQ(reading.code(decoder, 0), value);
}

TEST(IntegerCoder, ComesCloseToTheEntropyOfLongStreams) {
  for (const double scale : {0.3, 2.0, 10.0}) {
    const auto values = laplace(100'000, scale, 9);
    const double bits = static_cast<double>(encode_integers(values).size()) * 8;
    EXPECT_LT(bits, 1.03 * entropy(values)) << scale;
    EXPECT_GT(bits, 0.99 * entropy(values)) << scale;
  }
}

TEST(IntegerCoder, CostsAlmostNothingForAConstant) {
  EXPECT_LT(encode_integers(std::vector<int32_t>(10'000, 5)).size(), 100u);
}

TEST(IntegerCoder, CodesShortBlocksBetterFromTrainedStarts) {
  const auto starts = train_integer_starts(laplace(20'000, 30, 1));
  size_t plain = 0, trained = 0;
  for (uint32_t seed = 10; seed < 20; ++seed) {
    const auto values = laplace(30, 30, seed);
    plain += encode_integers(values).size();
    const auto bytes = encode_integers(values, starts);
    trained += bytes.size();
    const auto decoded = decode_integers(bytes, values.size(), starts);
    ASSERT_TRUE(decoded.ok());
    EXPECT_EQ(*decoded, values);
  }
  EXPECT_LT(static_cast<double>(trained), 0.9 * static_cast<double>(plain));
}

TEST(IntegerCoder, FindsDamageAndTruncation) {
  const auto bytes = encode_integers(laplace(50, 20, 2));
  for (size_t i = 0; i < bytes.size(); ++i) {
    auto damaged = bytes;
    damaged[i] ^= std::byte{0x04};
    EXPECT_EQ(decode_integers(damaged, 50).status().code(), StatusCode::kDataLoss) << i;
    EXPECT_FALSE(decode_integers(std::span(bytes).first(i), 50).ok()) << i;
  }
}

TEST(IntegerCoder, GivesSomeIntegersForAnyBytes) {
  std::mt19937 random(6);
  for (int run = 0; run < 200; ++run) {
    std::vector<std::byte> bytes(random() % 40);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
    BinaryDecoder decoder(bytes);
    IntegerModel model;
    for (int i = 0; i < 100; ++i) (void)model.code(decoder, 0);
  }
}

TEST(IntegerCoder, WritesTheSameBytesOnEveryMachine) {
  std::string text;
  for (const std::byte byte :
       encode_integers(std::vector<int32_t>{0, 1, -1, 5, -77, 4000, 0, 0, 2}))
    text += fmt::format("{:02x}", static_cast<int>(byte));
  EXPECT_EQ(text, "7dd39fed2006477330b610d7");
}

}  // namespace
}  // namespace engram::encoders
