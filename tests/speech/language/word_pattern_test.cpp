// SPDX-License-Identifier: Apache-2.0
#include "speech/language/word_pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/speech/language/question_words.h"

namespace engram::speech {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::joined;
using testing::words_of;

TEST(WordPattern, FitsEachOfItsAlternatives) {
  const WordPattern pattern("at what|which time");
  EXPECT_EQ(pattern.count_at(words_of("at what time"), 0), 3U);
  EXPECT_EQ(pattern.count_at(words_of("at which time was it"), 0), 3U);
  EXPECT_EQ(pattern.count_at(words_of("at that time"), 0), 0U);
  EXPECT_EQ(pattern.count_at(words_of("so at what time"), 1), 3U);
}

TEST(WordPattern, MayLackWhatIsOptional) {
  const WordPattern pattern("the? last|latest? reason");
  EXPECT_EQ(pattern.count_at(words_of("the last reason"), 0), 3U);
  EXPECT_EQ(pattern.count_at(words_of("latest reason"), 0), 2U);
  EXPECT_EQ(pattern.count_at(words_of("reason"), 0), 1U);
  EXPECT_EQ(pattern.count_at(words_of("the last"), 0), 0U);
}

TEST(WordPattern, MayLackAWordThatItNeedsLater) {
  EXPECT_EQ(WordPattern("the? the end").count_at(words_of("the end"), 0), 2U);
}

TEST(WordPattern, DoesNotGoBeyondTheEnd) {
  const WordPattern pattern("how long");
  EXPECT_EQ(pattern.count_at(words_of("how"), 0), 0U);
  EXPECT_EQ(pattern.count_at(words_of("how long"), 2), 0U);
  EXPECT_EQ(pattern.count_at({}, 0), 0U);
}

TEST(WordPatterns, AreCountedByTheLongestThatFits) {
  constexpr std::string_view kTexts[] = {"how", "how many times", "how many"};
  const WordPatterns patterns(kTexts);
  EXPECT_EQ(patterns.count_at(words_of("how many times was it"), 0), 3U);
  EXPECT_EQ(patterns.count_at(words_of("how many were there"), 0), 2U);
  EXPECT_EQ(patterns.count_at(words_of("why"), 0), 0U);
}

TEST(EraseWords, LeavesWhereSentencesBeginAndClausesEnd) {
  auto words = words_of("It fell. Well, where is it, my dear?");
  ASSERT_EQ(words.size(), 8U);
  erase_words(words, 6, 2);
  erase_words(words, 2, 1);
  ASSERT_EQ(joined(words), "it fell where is it");
  EXPECT_TRUE(words[2].begins_sentence);
  EXPECT_TRUE(words[4].ends_clause);
  erase_words(words, 0, words.size());
  EXPECT_THAT(words, IsEmpty());
}

TEST(PartsBetween, LeavesEmptyOnesOut) {
  EXPECT_THAT(parts_between("a|b||c|", '|'), ElementsAre("a", "b", "c"));
  EXPECT_THAT(parts_between("", ' '), IsEmpty());
}

}  // namespace
}  // namespace engram::speech
