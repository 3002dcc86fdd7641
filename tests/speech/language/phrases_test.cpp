// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>

#include "speech/language/question_phrases.h"
#include "speech/language/word_pattern.h"
#include "tests/speech/language/question_words.h"

namespace engram::speech {
namespace {

using testing::joined;

std::vector<QuestionWord> replaced(std::string_view question) {
  auto words = testing::words_of(question);
  replace_phrases(words);
  return words;
}

TEST(Phrases, ArePutInFewerWords) {
  EXPECT_EQ(joined(replaced("How come?")), "why");
  EXPECT_EQ(joined(replaced("What time did it fall?")), "when did it fall");
  EXPECT_EQ(joined(replaced("Where is the salt?")), "where is the salt");
}

TEST(Phrases, AreTheLongestThatBeginThere) {
  EXPECT_EQ(joined(replaced("How many seconds ago?")), "how_ago");
  EXPECT_EQ(joined(replaced("How many seconds?")), "how_long");
}

TEST(Phrases, ThatSayNothingHideNoPhraseBehindThem) {
  // "Not how often but" is left out, and "how many times" is a phrase of its
  // own.
  EXPECT_EQ(joined(replaced("Not how often but how many times was it?")), "how_often was it");
  EXPECT_EQ(joined(replaced("Did you keep count of what time it was?")), "when it was");
}

TEST(Phrases, LeaveWhereSentencesAndClausesBeginAndEnd) {
  const auto words = replaced("It fell. In the process of falling, how come?");
  EXPECT_EQ(joined(words), "it fell falling why");
  ASSERT_EQ(words.size(), 4U);
  EXPECT_TRUE(words[1].ends_clause);
  EXPECT_TRUE(words[2].begins_sentence);
  EXPECT_TRUE(words[2].ends_clause);
  EXPECT_TRUE(words[3].ends_clause);
}

TEST(Phrases, OfWhatYouDidBeginSentences) {
  EXPECT_EQ(joined(replaced("Everything you did?")), "what you did");
  EXPECT_EQ(joined(replaced("Was everything you did right?")), "was everything you did right");
}

/// Goes through the words that a pattern stands for, until `visit` returns
/// true.
class WordsOfPattern {
 public:
  using Visit = std::function<bool(const std::vector<QuestionWord>&)>;

  explicit WordsOfPattern(std::string_view pattern) : parts_(parts_between(pattern, ' ')) {}

  bool any(const Visit& visit) {
    words_.clear();
    return any_from(0, visit);
  }

 private:
  bool any_from(size_t part, const Visit& visit) {
    if (part == parts_.size()) return !words_.empty() && visit(words_);
    std::string_view text = parts_[part];
    const bool is_optional = text.ends_with('?');
    if (is_optional) text.remove_suffix(1);
    for (const std::string_view choice : parts_between(text, '|')) {
      words_.push_back({.text = std::string(choice), .given = {}});
      const bool is_found = any_from(part + 1, visit);
      words_.pop_back();
      if (is_found) return true;
    }
    return is_optional && any_from(part + 1, visit);
  }

  std::vector<std::string_view> parts_;
  std::vector<QuestionWord> words_;
};

TEST(Phrases, AreAllTakenForSomeWords) {
  size_t count = 0;
  for (const auto table : {phrases_of_asking(), phrases_of_deeds(), phrases_of_things()})
    for (const Phrase& phrase : table) {
      ++count;
      const bool is_taken = WordsOfPattern(phrase.words).any([&](std::vector<QuestionWord> words) {
        if (phrase_at(words, 0) == &phrase) return true;
        words.front().begins_sentence = true;
        return phrase_at(words, 0) == &phrase;
      });
      EXPECT_TRUE(is_taken) << "another phrase comes first wherever this one fits: '"
                            << phrase.words << "'";
    }
  EXPECT_GT(count, 700U);
}

}  // namespace
}  // namespace engram::speech
