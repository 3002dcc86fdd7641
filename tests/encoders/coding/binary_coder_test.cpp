// SPDX-License-Identifier: Apache-2.0
#include "encoders/coding/binary_coder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "encoders/coding/adaptive_bit.h"

namespace engram::encoders {
namespace {

std::vector<bool> random_bits(size_t count, double share, uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<bool> bits;
  for (size_t i = 0; i < count; ++i) bits.push_back(random() < share * 4294967296.0);
  return bits;
}

TEST(BinaryCoder, GivesBackBitsOfEveryProbability) {
  for (const BitProbability one : {1u, 2u, 300u, 32768u, 65000u, 65535u}) {
    const auto bits = random_bits(3000, one / 65536.0, one);
    BinaryEncoder encoder;
    for (const bool bit : bits) EXPECT_EQ(encoder.code(bit, one), bit);
    const auto bytes = encoder.finish();
    BinaryDecoder decoder(bytes);
    for (const bool bit : bits) ASSERT_EQ(decoder.code(false, one), bit);
  }
}

TEST(BinaryCoder, GivesBackTheUnlikely) {
  BinaryEncoder encoder;
  for (int i = 0; i < 500; ++i) encoder.code(i % 2 == 0, i % 2 == 0 ? 1 : 65535);
  const auto bytes = encoder.finish();
  BinaryDecoder decoder(bytes);
  for (int i = 0; i < 500; ++i)
    ASSERT_EQ(decoder.code(false, i % 2 == 0 ? 1 : 65535), i % 2 == 0) << i;
}

TEST(BinaryCoder, TakesNoBytesForNothing) {
  EXPECT_TRUE(BinaryEncoder().finish().empty());
}

TEST(BinaryCoder, CarriesThroughAnyNumberOfBytes) {
  // Likely zeros push the lower end up to just below a carry, a one then decides.
  for (int zeros = 1; zeros < 300; ++zeros) {
    BinaryEncoder encoder;
    for (int i = 0; i < zeros; ++i) encoder.code(false, 3);
    encoder.code(true, 3);
    const auto bytes = encoder.finish();
    BinaryDecoder decoder(bytes);
    for (int i = 0; i < zeros; ++i) ASSERT_FALSE(decoder.code(false, 3));
    ASSERT_TRUE(decoder.code(false, 3)) << zeros;
  }
}

TEST(BinaryCoder, WritesWhatTheProbabilitiesSay) {
  for (const double share : {0.01, 0.2, 0.5}) {
    const auto bits = random_bits(200'000, share, 7);
    const auto one = static_cast<BitProbability>(share * 65536);
    BinaryEncoder encoder;
    double ideal = 0;
    for (const bool bit : bits) {
      encoder.code(bit, one);
      ideal -= std::log2(bit ? one / 65536.0 : 1 - one / 65536.0);
    }
    EXPECT_NEAR(static_cast<double>(encoder.finish().size()) * 8, ideal, 0.002 * ideal) << share;
  }
}

TEST(BinaryCoder, WritesTheSameBytesOnEveryMachine) {
  BinaryEncoder encoder;
  for (uint32_t i = 0; i < 64; ++i) encoder.code((i * i) % 3 == 0, 1 + i * 1000);
  const std::vector<std::byte> bytes = encoder.finish();
  std::string text;
  for (const std::byte byte : bytes) text += fmt::format("{:02x}", static_cast<int>(byte));
  EXPECT_EQ(text, "00000d513ef4e3389cfdb3ce");
}

TEST(BinaryCoder, CodesEvenNumbersAtTheirWidth) {
  std::mt19937 random(3);
  std::vector<std::pair<uint32_t, int>> numbers;
  size_t bits = 0;
  for (int i = 0; i < 4000; ++i) {
    const int count = 1 + i % 16;
    numbers.emplace_back(random() & ((1u << count) - 1), count);
    bits += static_cast<size_t>(count);
  }
  BinaryEncoder encoder;
  for (const auto& [value, count] : numbers) EXPECT_EQ(encoder.code_even(value, count), value);
  const auto bytes = encoder.finish();
  EXPECT_LT(bytes.size(), bits / 8 + bits / 800 + 4);
  BinaryDecoder decoder(bytes);
  for (const auto& [value, count] : numbers) ASSERT_EQ(decoder.code_even(0, count), value);
  const std::vector<std::byte> ones(40, std::byte{0xff});
  BinaryDecoder hostile(ones);
  for (int i = 0; i < 400; ++i) EXPECT_LT(hostile.code_even(0, 5), 32u);
}

TEST(AdaptiveBit, MovesAsDivisionWould) {
  for (const BitProbability start : {1u, 77u, 20000u, 32768u, 65535u}) {
    for (const int seen : {0, 1, 5, 30, 61, 62, 125, 126, 254, 255}) {
      AdaptiveBit bit(start, seen);
      auto fast = static_cast<int>(start), slow = fast;
      for (int i = 0; i < 400; ++i) {
        const bool is_one = i % 7 < 3 || i > 250;
        const int target = is_one ? 65535 : 0, known = std::min(seen + i, 255);
        bit.update(is_one);
        fast += (target - fast) / std::min(known + 2, 64);
        slow += (target - slow) / std::min(known + 2, 128);
        ASSERT_EQ(bit.mean(), static_cast<uint32_t>(fast + slow) / 2) << start << ' ' << seen;
      }
    }
  }
}

TEST(AdaptiveBit, ApproachesTheEntropyOfItsBits) {
  for (const double share : {0.05, 0.3}) {
    const auto bits = random_bits(100'000, share, 11);
    AdaptiveBit model;
    BinaryEncoder encoder;
    for (const bool bit : bits) model.code(encoder, bit);
    const double ones = static_cast<double>(std::ranges::count(bits, true)) / 100'000;
    const double ideal = -100'000 * (ones * std::log2(ones) + (1 - ones) * std::log2(1 - ones));
    EXPECT_NEAR(static_cast<double>(encoder.finish().size()) * 8, ideal, 0.03 * ideal) << share;
  }
}

TEST(AdaptiveBit, StartsFromWhatItIsTold) {
  EXPECT_NEAR(AdaptiveBit(6000, 20).one(), 6000, 1);
  AdaptiveBit trusting(6000, 200), doubting(6000, 0);
  trusting.update(true);
  doubting.update(true);
  EXPECT_LT(trusting.one(), doubting.one());
}

TEST(AdaptiveBit, FollowsAChange) {
  AdaptiveBit model;
  for (int i = 0; i < 1000; ++i) model.update(false);
  EXPECT_LT(model.one(), 1000u);
  for (int i = 0; i < 100; ++i) model.update(true);
  EXPECT_GT(model.one(), 40000u);
}

}  // namespace
}  // namespace engram::encoders
