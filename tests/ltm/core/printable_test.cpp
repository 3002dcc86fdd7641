// SPDX-License-Identifier: Apache-2.0
#include "ltm/core/printable.h"

#include <gtest/gtest.h>

namespace engram {
namespace {

TEST(Printable, LeavesWhatPeopleWrite) {
  for (const char* text : {"", "Vision/RGB/head/cam", "Größe 1\\2", "机器人 🤖", "שלום"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, WritesControlCharactersAsEscapes) {
  EXPECT_EQ(printable("a\nb\r\tc"), "a\\nb\\r\\tc");
  EXPECT_EQ(printable("\x1b]0;owned\x07"), "\\x1b]0;owned\\x07");
  EXPECT_EQ(printable("\x1b[2J\x7f"), "\\x1b[2J\\x7f");
  EXPECT_EQ(printable(std::string_view("\0x", 2)), "\\x00x");
  // CSI as one character of the second control set.
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "\\x9b31m");
}

TEST(Printable, WritesWhatTurnsTextAsEscapes) {
  EXPECT_EQ(printable("a\u202eb\u2066c\u2028d\u200f"), "a\\u202eb\\u2066c\\u2028d\\u200f");
}

TEST(Printable, WritesBytesThatAreNoUtf8AsEscapes) {
  EXPECT_EQ(printable("a\xff\xc3"), "a\\xff\\xc3");
  EXPECT_EQ(printable("\x9b"
                      "2J"),
            "\\x9b2J");
}

TEST(Printable, LeavesLinesOfATextOfSeveral) {
  EXPECT_EQ(printable_lines("a\n\tb\r\n\x1b[1m"), "a\n\tb\\r\n\\x1b[1m");
}

TEST(Printable, LeavesTheMeaningOfJson) {
  EXPECT_EQ(printable_json("{\n  \"a\": \"\u202e\x7f\xc2\x9b\"}"),
            "{\n  \"a\": \"\\u202e\\u007f\\u009b\"}");
}

}  // namespace
}  // namespace engram
