// SPDX-License-Identifier: Apache-2.0
#include "speech/language/words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "tests/ltm/expect_status.h"

namespace engram::speech {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> texts_of(std::string_view question) {
  const auto words = split_words(question);
  EXPECT_OK(words);
  std::vector<std::string> texts;
  if (words.ok())
    for (const QuestionWord& word : *words) texts.push_back(word.text);
  return texts;
}

TEST(Words, WritesContractionsOut) {
  EXPECT_THAT(texts_of("Didn't you?"), ElementsAre("did", "not", "you"));
  EXPECT_THAT(texts_of("What’s there"), ElementsAre("what", "is", "there"));
}

TEST(Words, TellsWhatAShortDMeans) {
  EXPECT_THAT(texts_of("Where'd you put it"), ElementsAre("where", "did", "you", "put", "it"));
  EXPECT_THAT(texts_of("I'd like it"), ElementsAre("i", "would", "like", "it"));
  EXPECT_THAT(texts_of("if you'd been there"), ElementsAre("if", "you", "had", "been", "there"));
}

TEST(Words, KeepsTimesAndDatesWhole) {
  EXPECT_THAT(texts_of("at 8:05:12.5 on 2026-01-02."),
              ElementsAre("at", "8:05:12.5", "on", "2026-01-02"));
}

TEST(Words, SaysWhereSentencesBeginAndWhatTheyAre) {
  const auto words = split_words("You took it. When, please?");
  ASSERT_OK(words);
  ASSERT_EQ(words->size(), 5u);
  EXPECT_TRUE((*words)[2].ends_statement);
  EXPECT_TRUE((*words)[3].begins_sentence);
  EXPECT_TRUE((*words)[3].ends_clause);
  EXPECT_FALSE((*words)[4].ends_statement);
}

TEST(Words, RefusesWhatIsNoEnglishText) {
  EXPECT_EQ(split_words(" ?! ").status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(split_words("Где ты видел соль?").status().code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(split_words(std::string(kMaxQuestionBytes + 1, 'a')).status().code(),
            StatusCode::kInvalidArgument);
}

TEST(Words, RefusesSignsOfCode) {
  for (const char* question : {"executions | count", "where is {thing}?", "a * b", "c:\\"})
    EXPECT_FAILS(split_words(question), StatusCode::kInvalidArgument, "signs of a program");
}

TEST(Words, HaveBaseForms) {
  EXPECT_EQ(lemma_of("took"), "take");
  EXPECT_EQ(lemma_of("placing"), "place");
  EXPECT_EQ(lemma_of("grabbed"), "grab");
  EXPECT_EQ(lemma_of("this"), "this");
  EXPECT_EQ(lemma_of("glass"), "glass");
  EXPECT_EQ(lemma_of("salt"), "salt");
}

TEST(Words, AreAsFarApartAsTheirLetters) {
  EXPECT_EQ(letters_apart("grasp", "grasp", 2), 0);
  EXPECT_EQ(letters_apart("grasp", "garsp", 2), 1);
  EXPECT_EQ(letters_apart("bread", "break", 2), 1);
  EXPECT_EQ(letters_apart("salt", "elephant", 2), 3);
}

/// The same by the whole table.
int apart_by_table(const std::string& a, const std::string& b) {
  std::vector<std::vector<int>> cost(a.size() + 1, std::vector<int>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i)
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = static_cast<int>(i + j);
        continue;
      }
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1,
                             cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  return cost[a.size()][b.size()];
}

TEST(Words, AreAsFarApartAsAWholeTableSays) {
  std::mt19937 random(1);
  const auto word = [&] {
    std::string text(random() % 7, ' ');
    for (char& letter : text) letter = static_cast<char>('a' + random() % 4);
    return text;
  };
  for (int i = 0; i < 20000; ++i) {
    const std::string a = word(), b = word();
    const int max = static_cast<int>(random() % 4);
    ASSERT_EQ(letters_apart(a, b, max), std::min(apart_by_table(a, b), max + 1)) << a << " " << b;
  }
}

TEST(Words, NameNumbers) {
  EXPECT_EQ(number_named("three"), 3);
  EXPECT_EQ(number_named("a"), 1);
  EXPECT_EQ(number_named("12"), 12);
  EXPECT_EQ(number_named("sixty"), 60);
  EXPECT_EQ(number_named("seventy"), 70);
  EXPECT_EQ(number_named("eighty"), 80);
  EXPECT_EQ(number_named("ninety"), 90);
  EXPECT_EQ(number_named("hundred"), 100);
  EXPECT_EQ(number_named("salt"), -1);
  EXPECT_EQ(number_named(""), -1);
}

}  // namespace
}  // namespace engram::speech
