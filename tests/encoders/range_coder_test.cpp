// SPDX-License-Identifier: Apache-2.0
#include "encoders/range_coder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace engram::encoders {
namespace {

std::vector<int32_t> laplace_symbols(size_t count, double spread, uint32_t seed) {
  std::mt19937 random(seed);
  std::exponential_distribution<double> size(1.0 / spread);
  std::vector<int32_t> symbols;
  for (size_t i = 0; i < count; ++i)
    symbols.push_back(static_cast<int32_t>(size(random)) * (random() % 2 == 0 ? 1 : -1));
  return symbols;
}

FrequencyTable table_of(const std::vector<int32_t>& symbols, int32_t first, size_t size) {
  std::vector<uint64_t> counts(size);
  for (const int32_t symbol : symbols) {
    const int64_t at = static_cast<int64_t>(symbol) - first;
    if (at >= 0 && at < static_cast<int64_t>(size)) ++counts[static_cast<size_t>(at)];
  }
  return FrequencyTable::from_counts(first, counts);
}

std::vector<std::byte> encoded(const FrequencyTable& table, const std::vector<int32_t>& symbols) {
  RangeEncoder encoder;
  for (const int32_t symbol : symbols) encoder.put(table, symbol);
  return encoder.finish();
}

void expect_round_trip(const FrequencyTable& table, const std::vector<int32_t>& symbols) {
  const auto bytes = encoded(table, symbols);
  RangeDecoder decoder(bytes);
  for (size_t i = 0; i < symbols.size(); ++i)
    ASSERT_EQ(decoder.get(table), symbols[i]) << "symbol " << i << " of " << symbols.size();
}

TEST(RangeCoder, GivesBackRandomSymbolsOfManyLengths) {
  for (uint32_t seed = 0; seed < 200; ++seed) {
    const auto symbols = laplace_symbols(seed * 7, 0.2 + seed * 0.1, seed);
    expect_round_trip(table_of(symbols, -50, 101), symbols);
  }
}

TEST(RangeCoder, GivesBackValuesOutsideItsTable) {
  const std::vector<int32_t> symbols{0, 5, -5, 2, -2, 1000, -70000, INT32_MAX, INT32_MIN, 0, 1};
  expect_round_trip(FrequencyTable(), symbols);
}

TEST(RangeCoder, IsWithinTwoPercentOfTheIdealLength) {
  for (const double spread : {0.3, 1.0, 5.0, 40.0}) {
    const auto symbols = laplace_symbols(20000, spread, 3);
    const auto table = table_of(symbols, -1000, 2001);
    double bits = 0;
    for (const int32_t symbol : symbols) {
      const auto at = static_cast<size_t>(symbol + 1000);
      bits -= std::log2((table.start(at + 1) - table.start(at)) / std::exp2(FrequencyTable::kBits));
    }
    const auto size = static_cast<double>(encoded(table, symbols).size());
    EXPECT_LT(size, bits / 8 * 1.02 + 4) << "spread " << spread;
  }
}

TEST(RangeCoder, SpendsFewBytesOnWhatIsNearlyCertain) {
  const std::vector<int32_t> symbols(8192, 0);
  EXPECT_LT(encoded(table_of(symbols, 0, 1), symbols).size(), 8u);
}

TEST(RangeCoder, ReadsSomethingFromHostileBytes) {
  std::mt19937 random(9);
  const FrequencyTable table;
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::byte> bytes(random() % 64);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(i % 3 == 0 ? 0xff : random());
    RangeDecoder decoder(bytes);
    for (int k = 0; k < 200; ++k) static_cast<void>(decoder.get(table));
  }
}

TEST(FrequencyTable, KeepsItsFrequenciesWhenStored) {
  const auto table = table_of(laplace_symbols(5000, 3, 1), -20, 41);
  const auto stored = FrequencyTable::from_frequencies(table.first(), table.frequencies());
  ASSERT_TRUE(stored.ok()) << stored.status().to_string();
  EXPECT_EQ(stored->frequencies(), table.frequencies());
}

TEST(FrequencyTable, KeepsTheMiddleOfAVeryLongHistogram) {
  std::vector<uint64_t> counts(60000, 0);
  counts[40000] = 100;
  const auto table = FrequencyTable::from_counts(-30000, counts);
  EXPECT_LE(table.symbols(), FrequencyTable::kMaxSymbols + 1);
  expect_round_trip(table, {10000, 9999, -30000, 29999});
}

TEST(FrequencyTable, RejectsBrokenFrequencies) {
  EXPECT_FALSE(FrequencyTable::from_frequencies(0, std::vector<uint16_t>{}).ok());
  EXPECT_FALSE(FrequencyTable::from_frequencies(0, std::vector<uint16_t>{16384, 16383}).ok());
  EXPECT_FALSE(FrequencyTable::from_frequencies(0, std::vector<uint16_t>{32767, 0, 1}).ok());
  EXPECT_EQ(FrequencyTable::from_frequencies(INT32_MAX, std::vector<uint16_t>{16384, 16384})
                .status()
                .code(),
            StatusCode::kDataLoss);
}

}  // namespace
}  // namespace engram::encoders
