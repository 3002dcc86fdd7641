// SPDX-License-Identifier: Apache-2.0
#include "server/service/decoded_cache.h"

#include <gtest/gtest.h>

namespace engram::server {
namespace {

ltm::MemoryId id(int64_t at) {
  return ltm::MemoryId::parse("A/b/c/d")->at(time_from_ns(at));
}

ltm::SnapshotResult snapshot(int64_t at, size_t bytes) {
  ltm::SnapshotResult made;
  made.time = time_from_ns(at);
  made.append(std::string(bytes, 'x'), {});
  return made;
}

TEST(DecodedCache, GivesWhatItWasGiven) {
  DecodedCache cache(10'000);
  EXPECT_FALSE(cache.find(id(1)).has_value());
  cache.put(id(1), snapshot(1, 10));
  EXPECT_EQ(cache.find(id(1)), snapshot(1, 10));
  cache.put(id(1), snapshot(1, 20));
  EXPECT_EQ(cache.find(id(1)), snapshot(1, 20));
}

TEST(DecodedCache, LetsGoOfWhatWasNotAskedForLongest) {
  DecodedCache cache(4'000);
  for (int64_t at = 1; at <= 3; ++at) cache.put(id(at), snapshot(at, 1000));
  ASSERT_TRUE(cache.find(id(1)).has_value());
  cache.put(id(4), snapshot(4, 1000));
  EXPECT_TRUE(cache.find(id(1)).has_value());
  EXPECT_FALSE(cache.find(id(2)).has_value());
  EXPECT_LE(cache.bytes(), 4'000u);
}

TEST(DecodedCache, DoesNotKeepWhatIsTooLarge) {
  DecodedCache cache(4'000);
  cache.put(id(1), snapshot(1, 1000));
  cache.put(id(2), snapshot(2, 5000));
  EXPECT_TRUE(cache.find(id(1)).has_value());
  EXPECT_FALSE(cache.find(id(2)).has_value());
}

TEST(DecodedCache, CountsNothingOnceItIsEmpty) {
  DecodedCache cache(100'000);
  for (int64_t at = 0; at < 20; ++at) cache.put(id(at % 5), snapshot(at, 100));
  for (int64_t at = 0; at < 5; ++at) cache.erase(id(at));
  cache.erase(id(77));
  EXPECT_EQ(cache.bytes(), 0u);
}

}  // namespace
}  // namespace engram::server
