// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/byte_fields.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

namespace engram {
namespace {

TEST(ByteFields, AreReadAsTheyWereWritten) {
  std::vector<std::byte> bytes;
  FieldWriter out(bytes);
  out.number(uint16_t{0x0102});
  out.number(int64_t{-3});
  out.text("a text");
  out.text("");
  out.bytes(as_bytes("raw"));
  EXPECT_EQ(as_text(std::span(bytes).first(2)), "\x02\x01") << "the lowest byte comes first";
  FieldReader in(bytes);
  EXPECT_EQ(in.number<uint16_t>(), 0x0102);
  EXPECT_EQ(in.number<int64_t>(), -3);
  EXPECT_EQ(in.at(), 10U);
  EXPECT_EQ(in.text(), "a text");
  EXPECT_EQ(in.text(), "");
  std::array<std::byte, 3> raw{};
  in.fill(raw);
  EXPECT_EQ(as_text(raw), "raw");
  EXPECT_TRUE(in.is_whole());
  EXPECT_EQ(in.rest(), 0U);
  EXPECT_EQ(in.at(), bytes.size());
}

TEST(ByteFields, TheFirstMissingFieldIsToldAndAllLaterOnesAreEmpty) {
  std::vector<std::byte> bytes;
  FieldWriter out(bytes);
  out.number(uint8_t{7});
  // A size that lies, before bytes that would fit a later field.
  out.number(std::numeric_limits<uint32_t>::max());
  out.bytes(as_bytes("rest"));
  FieldReader in(bytes);
  EXPECT_EQ(in.number<uint8_t>(), 7);
  EXPECT_TRUE(in.text().empty());
  EXPECT_FALSE(in.is_whole());
  EXPECT_EQ(in.at(), 5U);
  EXPECT_EQ(in.missing(), std::numeric_limits<uint32_t>::max());
  EXPECT_EQ(in.rest(), 0U);
  EXPECT_EQ(in.number<uint32_t>(), 0U);
  std::array<std::byte, 2> left{std::byte{1}, std::byte{2}};
  in.fill(left);
  EXPECT_EQ(left[0], std::byte{1}) << "what is not there changes nothing";
  EXPECT_FALSE(in.is_whole());
  EXPECT_EQ(in.missing(), std::numeric_limits<uint32_t>::max());
}

}  // namespace
}  // namespace engram
