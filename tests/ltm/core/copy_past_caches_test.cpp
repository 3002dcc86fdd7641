// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/copy_past_caches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace engram {
namespace {

TEST(CopyPastCaches, CopiesAnySizeFromAndToAnywhere) {
  std::vector<uint8_t> source(1000);
  std::iota(source.begin(), source.end(), uint8_t{1});
  for (const size_t size : {0, 1, 15, 16, 63, 64, 65, 127, 128, 129, 700})
    for (size_t from = 0; from < 70; from += 3)
      for (size_t to = 0; to < 70; ++to) {
        std::vector<uint8_t> target(1000, 0);
        copy_past_caches(std::as_bytes(std::span(source).subspan(from, size)),
                         std::as_writable_bytes(std::span(target).subspan(to, size)));
        const auto begin = target.begin() + static_cast<std::ptrdiff_t>(to);
        const auto end = begin + static_cast<std::ptrdiff_t>(size);
        ASSERT_TRUE(std::equal(begin, end, source.begin() + static_cast<std::ptrdiff_t>(from)));
        ASSERT_EQ(std::count(target.begin(), begin, 0), static_cast<std::ptrdiff_t>(to));
        ASSERT_EQ(std::count(end, target.end(), 0), target.end() - end) << size << " to " << to;
      }
}

}  // namespace
}  // namespace engram
