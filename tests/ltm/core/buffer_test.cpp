// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/buffer.h"

#include <gtest/gtest.h>

#include <optional>

namespace engram {
namespace {

TEST(Buffer, TakesVectorsWithoutCopyingThem) {
  std::vector<int32_t> values{1, 2, 3};
  const auto* data = reinterpret_cast<const std::byte*>(values.data());
  const Buffer buffer = Buffer::take(std::move(values));
  EXPECT_EQ(buffer.data(), data);
  EXPECT_EQ(buffer.size(), 12u);
}

TEST(Buffer, SlicesKeepTheWholeAlive) {
  std::optional<Buffer> whole = Buffer::copy(as_bytes("hello world"));
  const Buffer part = whole->slice(6, 5);
  whole.reset();
  EXPECT_EQ(as_text(part.bytes()), "world");
  EXPECT_EQ(part.owner().use_count(), 1);
}

TEST(Buffer, CanBeEmpty) {
  EXPECT_TRUE(Buffer().empty());
  EXPECT_TRUE(Buffer::take(std::vector<double>()).empty());
  EXPECT_TRUE(Buffer::copy({}).slice(0, 0).empty());
}

}  // namespace
}  // namespace engram
