// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "speech/language/question_phrases.h"
#include "tests/ltm/expect_status.h"

namespace engram::speech {
namespace {

using ::testing::ElementsAre;

std::vector<QuestionWord> replaced(std::string_view question) {
  auto words = split_words(question);
  EXPECT_OK(words);
  if (!words.ok()) return {};
  replace_phrases(*words);
  return *std::move(words);
}

std::vector<std::string> texts_of(const std::vector<QuestionWord>& words) {
  std::vector<std::string> texts;
  for (const QuestionWord& word : words) texts.push_back(word.text);
  return texts;
}

TEST(Phrases, ArePutInFewerWords) {
  EXPECT_THAT(texts_of(replaced("How come?")), ElementsAre("why"));
  EXPECT_THAT(texts_of(replaced("What time was that?")), ElementsAre("when", "was", "that"));
  EXPECT_THAT(texts_of(replaced("Where is the salt?")), ElementsAre("where", "is", "the", "salt"));
}

TEST(Phrases, AreTheLongestThatBeginThere) {
  EXPECT_THAT(texts_of(replaced("How many seconds ago?")), ElementsAre("how_ago"));
  EXPECT_THAT(texts_of(replaced("How many seconds?")), ElementsAre("how_long"));
}

TEST(Phrases, ThatSayNothingHideNoPhraseBehindThem) {
  // "Not how often but" is left out, and "how many times" is a phrase of its own.
  EXPECT_THAT(texts_of(replaced("Not how often but how many times was it?")),
              ElementsAre("how_often", "was", "it"));
  EXPECT_THAT(texts_of(replaced("Did you keep count of what time it was?")),
              ElementsAre("when", "it", "was"));
}

TEST(Phrases, LeaveWhereSentencesAndClausesBeginAndEnd) {
  const auto words = replaced("It fell. In the process of falling, how come?");
  EXPECT_THAT(texts_of(words), ElementsAre("it", "fell", "falling", "why"));
  ASSERT_EQ(words.size(), 4U);
  EXPECT_TRUE(words[1].ends_clause);
  EXPECT_TRUE(words[2].begins_sentence);
  EXPECT_TRUE(words[2].ends_clause);
  EXPECT_TRUE(words[3].ends_clause);
}

TEST(Phrases, OfWhatYouDidBeginSentences) {
  EXPECT_THAT(texts_of(replaced("Everything you did?")), ElementsAre("what", "you", "did"));
  EXPECT_THAT(texts_of(replaced("Was everything you did right?")),
              ElementsAre("was", "everything", "you", "did", "right"));
}

}  // namespace
}  // namespace engram::speech
