// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/utf8.h"

#include <gtest/gtest.h>

namespace engram {
namespace {

TEST(Utf8, IsWhatUnicodeSays) {
  for (const char* text : {"", "a", "\x7f", "ü", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80",
                           "机", "\xf0\x90\x80\x80", "🤖", "\xf4\x8f\xbf\xbf"})
    EXPECT_TRUE(is_utf8(text)) << text;
  for (const char* text : {"\x80", "\xbf", "\xc0\x80", "\xc1\xbf", "\xc2", "\xe0\x9f\xbf",
                           "\xe2\x82", "\xed\xa0\x80", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80",
                           "\xf5\x80\x80\x80", "\xff", "a\xc3", "\xc3(", "x\xe2\x28\xa1"})
    EXPECT_FALSE(is_utf8(text)) << text;
}

TEST(Utf8, IsCutBetweenCharacters) {
  EXPECT_EQ(cut_utf8("abc", 3), "abc");
  EXPECT_EQ(cut_utf8("abc", 2), "ab");
  // "a", two bytes, three bytes.
  const std::string_view text = "a\xc3\xa9\xe2\x82\xac";
  EXPECT_EQ(cut_utf8(text, 6), text);
  EXPECT_EQ(cut_utf8(text, 5), "a\xc3\xa9");
  EXPECT_EQ(cut_utf8(text, 3), "a\xc3\xa9");
  EXPECT_EQ(cut_utf8(text, 2), "a");
  EXPECT_EQ(cut_utf8(text, 0), "");
  // Bytes that are none of a character are nothing, and do no harm.
  EXPECT_EQ(cut_utf8("\x80\x80\x80", 2), "");
}

}  // namespace
}  // namespace engram
