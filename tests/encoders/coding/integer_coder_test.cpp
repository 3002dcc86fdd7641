// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/integer_coder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

namespace engram::encoders {
namespace {

using Integers = std::vector<int64_t>;

std::vector<std::byte> encode(const Integers& values) {
  BinaryEncoder encoder;
  IntegerModel model;
  for (const int64_t value : values) EXPECT_EQ(model.code(encoder, value), value);
  return encoder.finish();
}

Integers decode(const std::vector<std::byte>& bytes, size_t count) {
  BinaryDecoder decoder(bytes);
  IntegerModel model;
  Integers values;
  for (size_t i = 0; i < count; ++i) values.push_back(model.code(decoder, 0));
  return values;
}

Integers laplace(size_t count, double scale, uint32_t seed) {
  std::mt19937 random(seed);
  Integers values;
  for (size_t i = 0; i < count; ++i) {
    const double size = -scale * std::log((random() + 1.0) / 4294967297.0);
    values.push_back(std::lround(random() % 2 == 0 ? size : -size));
  }
  return values;
}

/// Of the values as they are counted. Unit: bits.
double entropy(const Integers& values) {
  std::map<int64_t, double> counts;
  for (const int64_t value : values) counts[value] += 1;
  double bits = 0;
  for (const auto& [value, count] : counts)
    bits -= count * std::log2(count / static_cast<double>(values.size()));
  return bits;
}

TEST(IntegerModel, GivesBackWhatItWasGiven) {
  std::mt19937_64 random(5);
  Integers anything;
  for (int i = 0; i < 5000; ++i) anything.push_back(static_cast<int64_t>(random()));
  for (const Integers& values :
       {Integers{}, Integers{0}, Integers(5000, 17), Integers(5000, INT64_MIN),
        Integers{INT64_MIN, INT64_MAX, -1, 0, 1, int64_t{1} << 40}, laplace(5000, 40, 3), anything})
    EXPECT_EQ(decode(encode(values), values.size()), values);
}

TEST(IntegerModel, ComesCloseToTheEntropyOfLongStreams) {
  for (const double scale : {0.3, 2.0, 10.0}) {
    const auto values = laplace(100'000, scale, 9);
    const double bits = static_cast<double>(encode(values).size()) * 8;
    EXPECT_LT(bits, 1.03 * entropy(values)) << scale;
    EXPECT_GT(bits, 0.99 * entropy(values)) << scale;
  }
}

TEST(IntegerModel, CostsAlmostNothingForAConstant) {
  EXPECT_LT(encode(Integers(10'000, 5)).size(), 100u);
}

TEST(IntegerModel, ReadsIntegersFromAnyBytes) {
  std::mt19937 random(6);
  std::set<int> widths;
  for (int run = 0; run < 200; ++run) {
    std::vector<std::byte> bytes(12 + random() % 400);
    for (std::byte& byte : bytes) byte = std::byte(random());
    // Half of them begin with the end of the likely half, which means "not zero", and with zeros,
    // which mean ones: the more of them the wider.
    const std::vector<std::byte> half{std::byte{0x7f}, std::byte{0xff}, std::byte{0x80}};
    if (run % 2 == 0)
      std::fill_n(std::ranges::copy(half, bytes.begin()).out, run % 9, std::byte{0});
    const Integers values = decode(bytes, 100);
    EXPECT_EQ(decode(encode(values), 100), values) << "what is read can be written";
    bytes.resize(bytes.size() + 30);
    EXPECT_EQ(decode(bytes, 100), values) << "behind the end come zeros";
    for (const int64_t value : values) widths.insert(std::ilogb(std::abs(1.0 * value) + 0.5));
  }
  EXPECT_GT(widths.size(), 40u) << "integers of most widths were met";
}

TEST(IntegerModel, WritesTheSameBytesOnEveryMachine) {
  std::string text;
  for (const std::byte byte : encode({0, 1, -1, 5, -77, 4000, 0, 0, 2}))
    text += fmt::format("{:02x}", static_cast<int>(byte));
  EXPECT_EQ(text, "7cc6afdd86dcaa8a80");
}

}  // namespace
}  // namespace engram::encoders
