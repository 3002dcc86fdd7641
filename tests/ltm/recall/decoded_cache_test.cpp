// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/decoded_cache.h"

#include <gtest/gtest.h>

namespace engram::ltm {
namespace {

constexpr Prefer kForm = Prefer::kRecorded;

MemoryId id(int64_t at) {
  return MemoryId::parse("A/b/c/d")->at(time_from_ns(at));
}

SnapshotResult snapshot(int64_t at, size_t bytes) {
  SnapshotResult made;
  made.time = time_from_ns(at);
  made.append(std::string(bytes, 'x'), {});
  return made;
}

TEST(DecodedCache, GivesWhatItWasGiven) {
  DecodedCache cache(10'000);
  EXPECT_FALSE(cache.find(id(1), kForm).has_value());
  cache.put(id(1), kForm, snapshot(1, 10));
  EXPECT_EQ(cache.find(id(1), kForm), snapshot(1, 10));
  cache.put(id(1), kForm, snapshot(1, 20));
  EXPECT_EQ(cache.find(id(1), kForm), snapshot(1, 20));
}

TEST(DecodedCache, LetsGoOfWhatWasNotAskedForLongest) {
  DecodedCache cache(6'500);  // Each takes about 2,000.
  for (int64_t at = 1; at <= 3; ++at) cache.put(id(at), kForm, snapshot(at, 1000));
  ASSERT_TRUE(cache.find(id(1), kForm).has_value());
  cache.put(id(4), kForm, snapshot(4, 1000));
  EXPECT_TRUE(cache.find(id(1), kForm).has_value());
  EXPECT_FALSE(cache.find(id(2), kForm).has_value());
  EXPECT_LE(cache.bytes(), 6'500u);
}

TEST(DecodedCache, DoesNotKeepWhatIsTooLarge) {
  DecodedCache cache(4'000);
  cache.put(id(1), kForm, snapshot(1, 1000));
  cache.put(id(2), kForm, snapshot(2, 5000));
  EXPECT_TRUE(cache.find(id(1), kForm).has_value());
  EXPECT_FALSE(cache.find(id(2), kForm).has_value());
}

TEST(DecodedCache, KeepsBothFormsApartAndErasesThemTogether) {
  DecodedCache cache(10'000);
  cache.put(id(1), Prefer::kRecorded, snapshot(1, 10));
  cache.put(id(1), Prefer::kLatent, snapshot(1, 20));
  EXPECT_EQ(cache.find(id(1), Prefer::kRecorded), snapshot(1, 10));
  EXPECT_EQ(cache.find(id(1), Prefer::kLatent), snapshot(1, 20));
  cache.erase(id(1));
  EXPECT_FALSE(cache.find(id(1), Prefer::kRecorded).has_value());
  EXPECT_FALSE(cache.find(id(1), Prefer::kLatent).has_value());
}

TEST(DecodedCache, CountsNothingOnceItIsEmpty) {
  DecodedCache cache(100'000);
  for (int64_t at = 0; at < 20; ++at) cache.put(id(at % 5), kForm, snapshot(at, 100));
  for (int64_t at = 0; at < 5; ++at) cache.erase(id(at));
  cache.erase(id(77));
  EXPECT_EQ(cache.bytes(), 0u);
}

}  // namespace
}  // namespace engram::ltm
