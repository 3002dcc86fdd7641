// SPDX-License-Identifier: Apache-2.0
#include "speech/language/english.h"

#include <gtest/gtest.h>

#include "tests/speech/language/question_words.h"

namespace engram::speech {
namespace {

using testing::joined;
using testing::words_of;

std::string without_tags(std::string_view question) {
  auto words = words_of(question);
  take_question_tags(words);
  return joined(words);
}

std::string without_endearments(std::string_view question) {
  auto words = words_of(question);
  take_endearments(words);
  return joined(words);
}

struct Polite {
  std::string left;
  bool is_taken = false;
};

Polite without_politeness(std::string_view question) {
  auto words = words_of(question);
  const bool is_taken = take_politeness(words);
  return {joined(words), is_taken};
}

TEST(QuestionTags, MakeAQuestionOfAStatement) {
  EXPECT_EQ(without_tags("You took the salt, didn't you?"), "whether you took the salt");
  EXPECT_EQ(without_tags("It worked. Is that right?"), "whether it worked");
  EXPECT_EQ(without_tags("It worked, didn't it, in the end?"), "whether it worked in the end");
}

TEST(QuestionTags, SayNothingBehindAQuestion) {
  EXPECT_EQ(without_tags("Did you take the salt, yes or no?"), "did you take the salt");
  EXPECT_EQ(without_tags("Where is the salt, right?"), "where is the salt");
}

TEST(QuestionTags, StandBehindWhatTheyAsk) {
  EXPECT_EQ(without_tags("Is that so?"), "is that so");
  EXPECT_EQ(without_tags("Is the right hand free?"), "is the right hand free");
}

TEST(Endearments, StandBetweenMarks) {
  EXPECT_EQ(without_endearments("Where is the salt, my dear?"), "where is the salt");
  EXPECT_EQ(without_endearments("Good robot, where is it?"), "where is it");
  EXPECT_EQ(without_endearments("Where is my dear mug?"), "where is my dear mug");
  EXPECT_EQ(without_endearments("Sweetheart?"), "sweetheart");
}

TEST(Politeness, IsTakenOff) {
  for (const char* question :
       {"Could you please tell me where it is?", "I would like to know where it is.",
        "Please tell me where it is.", "I forgot where it is.", "Do you know where it is?"}) {
    const Polite polite = without_politeness(question);
    EXPECT_EQ(polite.left, "where it is") << question;
    EXPECT_TRUE(polite.is_taken) << question;
  }
}

TEST(Politeness, MayComeTwiceOrBehindAGreeting) {
  EXPECT_EQ(without_politeness("Do you remember, could you tell me what it was?").left,
            "what it was");
  EXPECT_EQ(without_politeness("Hello, could you tell me what it was?").left, "hello what it was");
}

TEST(Politeness, LeavesWhetherWhereThatWasAskedFor) {
  EXPECT_EQ(without_politeness("Please confirm that you took it.").left, "whether you took it");
  EXPECT_EQ(without_politeness("Is it true that you took it?").left, "whether you took it");
}

TEST(Politeness, IsNoPartOfOtherQuestions) {
  for (const char* question : {"Where is it?", "Did you tell me where it is?", "I forgot it."})
    EXPECT_FALSE(without_politeness(question).is_taken) << question;
}

TEST(EnglishWords, AreOfTheGrammarOrSayNothing) {
  EXPECT_TRUE(is_grammar_lemma("where"));
  EXPECT_TRUE(is_grammar_lemma("grasp"));
  EXPECT_FALSE(is_grammar_lemma("elephant"));
  EXPECT_TRUE(is_filler("please"));
  EXPECT_TRUE(is_filler("gently"));
  EXPECT_FALSE(is_filler("elephant"));
  EXPECT_TRUE(english_spellings().contains("grasping"));
  EXPECT_TRUE(english_spellings().contains("gripped"));
}

}  // namespace
}  // namespace engram::speech
