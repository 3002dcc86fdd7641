// SPDX-License-Identifier: Apache-2.0
#include "speech/language/grammar.h"

#include <gtest/gtest.h>

#include "tests/speech/known_kitchen.h"

namespace engram::speech {
namespace {

class GrammarOfKitchen : public testing::KnownKitchen {
 protected:
  void SetUp() override {
    KnownKitchen::SetUp();
    lexicon_ = std::make_unique<Lexicon>(*facts_);
  }

  ParsedQuestion parsed(std::string_view question) {
    const auto words = question_in_words(question, *lexicon_, *make_word_tagger(),
                                         testing::second(60), DayZone::kUtc);
    EXPECT_OK(words);
    return words.ok() ? parse_question(*words, *lexicon_) : ParsedQuestion();
  }

  std::unique_ptr<Lexicon> lexicon_;
};

TEST_F(GrammarOfKitchen, ReadsNothingThatAProgramWouldLeaveOut) {
  struct Pair {
    const char* said;      ///< A program says all of it.
    const char* left_out;  ///< The same, and more than programs say.
  };
  constexpr Pair kPairs[] = {
      {"Did you pick up the salt?", "Did you pick up the salt gently?"},
      {"Did you pick up the salt?", "Did you pick up the salt twice?"},
      {"Did you pick up the salt?", "Did Ada pick up the salt?"},
      {"Did you pick up the salt?", "Did you pick up the salt and the tea?"},
      {"Did you pick up the salt?", "Did you always pick up the salt?"},
      {"Did anybody stop you?", "Did you stop Ada?"},
      {"What did you pick up?", "What did you not pick up?"},
      {"What did you do?", "What did you do besides driving?"},
      {"When did you pick up the salt?", "When did you pick up the salt in March?"},
      {"How long did you drive?", "How long did you drive on average?"},
      {"What did you do?", "What did you do between the orders?"},
      {"Which hand did you use?", "Which of your hands did you use most?"}};
  for (const auto& [said, left_out] : kPairs) {
    EXPECT_TRUE(parsed(said).program) << said << ": " << parsed(said).refusal;
    const ParsedQuestion refused = parsed(left_out);
    EXPECT_FALSE(refused.program) << left_out << ": " << refused.program->to_string();
    EXPECT_FALSE(refused.refusal.empty()) << left_out;
    EXPECT_TRUE(refused.is_unread) << left_out;
  }
}

TEST_F(GrammarOfKitchen, KnowsWhatIsNoQuestionOfAMemory) {
  for (const char* text :
       {"What will you do tomorrow?", "Bring me the salt.", "Could you bring me the salt?",
        "You picked up the salt.", "What a mess!", "The violin is on the table."}) {
    const ParsedQuestion refused = parsed(text);
    EXPECT_FALSE(refused.program) << text;
    EXPECT_FALSE(refused.is_unread) << text;
  }
  EXPECT_TRUE(parsed("You picked up the salt?").program);
  EXPECT_TRUE(parsed("Well, did you pick up the salt.").program);
  EXPECT_TRUE(parsed("The salt, is it on the table.").program);
  // Whoever wants to be told asks, and more than whether it is so.
  for (const char* text :
       {"Tally the times you properly grabbed something.", "Count the things on the table.",
        "You picked up the salt; justify it.", "Object inventory, table.",
        "Mummy wants to know if you picked up the salt.",
        "You did put the salt down, did you not? Tell the court on what."}) {
    const ParsedQuestion told = parsed(text);
    EXPECT_FALSE(told.program && told.program->has_step(StepKind::kExists)) << text;
    EXPECT_TRUE(told.program || told.is_unread) << text;
  }
}

TEST_F(GrammarOfKitchen, IsLessSureOfWhatItCorrects) {
  const ParsedQuestion right = parsed("Where is the salt?");
  const ParsedQuestion mistyped = parsed("Whree is the salt?");
  ASSERT_TRUE(right.program);
  ASSERT_TRUE(mistyped.program);
  EXPECT_EQ(right.program->to_string(), mistyped.program->to_string());
  EXPECT_LT(mistyped.confidence, right.confidence);
}

}  // namespace
}  // namespace engram::speech
