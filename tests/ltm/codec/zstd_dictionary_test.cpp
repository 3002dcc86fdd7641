// SPDX-License-Identifier: Apache-2.0
#include "ltm/codec/zstd_dictionary.h"

#include <array>
#include <thread>

#include "ltm/codec/zstd.h"
#include "ltm/idf/binary.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/random_values.h"

namespace engram::ltm {
namespace {

/// IDF values of a small struct, 33 bytes each.
std::vector<Buffer> small_values(size_t count) {
  std::vector<Buffer> values;
  for (size_t i = 0; i < count; ++i)
    values.push_back(Buffer::take(*idf::encode(
        idf::Dict{{"index", static_cast<int32_t>(i)}, {"speed", 0.25 * static_cast<double>(i)}})));
  return values;
}

TEST(ZstdDictionary, GivesBackTheBytes) {
  const auto samples = small_values(1000);
  const auto dictionary = ZstdDictionary::train(samples, {});
  ASSERT_OK(dictionary);
  RandomValues random(61);
  std::vector<std::byte> other(5000);
  for (std::byte& byte : other) byte = static_cast<std::byte>(random.bits());
  std::vector<Buffer> values = samples;
  values.push_back(Buffer());
  values.push_back(Buffer::take(other));
  for (const Buffer& value : values) {
    const auto packed = dictionary->compress(value.bytes());
    const auto plain = dictionary->decompress(packed, value.size());
    ASSERT_OK(plain);
    EXPECT_TRUE(std::ranges::equal(*plain, value.bytes()));
  }
}

TEST(ZstdDictionary, MakesSmallValuesSmaller) {
  const auto values = small_values(2000);
  const auto dictionary = *ZstdDictionary::train({values.data(), 1000}, {});
  size_t with = 0, without = 0;
  for (size_t i = 1000; i < values.size(); ++i) {
    with += dictionary.compress(values[i].bytes()).size();
    without += compress_zstd(values[i].bytes()).size();
  }
  EXPECT_LT(2 * with, without);
}

TEST(ZstdDictionary, IsTheSameFromItsBytes) {
  const auto samples = small_values(1000);
  const auto dictionary = *ZstdDictionary::train(samples, {});
  const auto again = ZstdDictionary::from_bytes(dictionary.bytes());
  ASSERT_OK(again);
  EXPECT_EQ(again->id(), dictionary.id());
  EXPECT_NE(again->id(), 0u);
  const auto packed = dictionary.compress(samples[7].bytes());
  EXPECT_EQ(again->compress(samples[7].bytes()), packed);
  EXPECT_OK(again->decompress(packed, samples[7].size()));
  EXPECT_TRUE(std::ranges::equal((*ZstdDictionary::train(samples, {})).bytes().bytes(),
                                 dictionary.bytes().bytes()));
}

TEST(ZstdDictionary, RefusesWhatTeachesNothing) {
  EXPECT_FAILS(ZstdDictionary::train({}, {}), StatusCode::kInvalidArgument, "0 samples");
  EXPECT_FAILS(ZstdDictionary::train(small_values(2), {}), StatusCode::kInvalidArgument,
               "2 samples");
  EXPECT_FAILS(ZstdDictionary::train(small_values(1000), {.max_bytes = 10}),
               StatusCode::kInvalidArgument, "needs 256");
  EXPECT_FAILS(ZstdDictionary::train(small_values(1000), {.level = 0}),
               StatusCode::kInvalidArgument, "needs 1 to 19");
}

TEST(ZstdDictionary, SurvivesDamage) {
  RandomValues random(62);
  const auto samples = small_values(1000);
  const auto dictionary = *ZstdDictionary::train(samples, {});
  EXPECT_FAILS(ZstdDictionary::from_bytes({}), StatusCode::kDataLoss, "no dictionary");
  EXPECT_FAILS(dictionary.decompress({}, 100), StatusCode::kDataLoss, "no frame");
  const auto packed = dictionary.compress(samples[7].bytes());
  EXPECT_FAILS(dictionary.decompress(packed, 10), StatusCode::kDataLoss, "at most 10");
  for (size_t size = 0; size < packed.size(); ++size)
    EXPECT_FAILS(dictionary.decompress({packed.data(), size}, 1000), StatusCode::kDataLoss, "");
  for (int i = 0; i < 2000; ++i) {
    auto damaged = packed;
    damaged[random.below(damaged.size())] = static_cast<std::byte>(random.bits());
    const auto plain = dictionary.decompress(damaged, 1000);
    if (!plain.ok()) {
      EXPECT_FAILS(plain, StatusCode::kDataLoss, "");
    }
    std::vector<std::byte> bytes(dictionary.bytes().bytes().begin(),
                                 dictionary.bytes().bytes().end());
    bytes[random.below(std::min<size_t>(bytes.size(), 300))] =
        static_cast<std::byte>(random.bits());
    const auto hostile = ZstdDictionary::from_bytes(Buffer::take(bytes));
    if (hostile.ok()) static_cast<void>(hostile->decompress(packed, 1000).ok());
  }
}

TEST(ZstdDictionary, ServesFourThreadsAndOtherDictionariesBetween) {
  const auto samples = small_values(1000);
  const auto one = *ZstdDictionary::train(samples, {});
  const auto two = *ZstdDictionary::train({samples.data() + 500, 500}, {.max_bytes = 512});
  const auto expected_one = one.compress(samples[3].bytes());
  const auto expected_two = two.compress(samples[3].bytes());
  std::array<bool, 4> is_same{};
  {
    std::vector<std::jthread> threads;
    for (bool& same : is_same)
      threads.emplace_back([&] {
        same = true;
        for (int i = 0; i < 200; ++i)
          same = same && one.compress(samples[3].bytes()) == expected_one &&
                 two.compress(samples[3].bytes()) == expected_two &&
                 two.decompress(expected_two, 100).ok() && one.decompress(expected_one, 100).ok();
      });
  }
  EXPECT_THAT(is_same, ::testing::Each(true));
}

}  // namespace
}  // namespace engram::ltm
