// SPDX-License-Identifier: Apache-2.0
#include "speech/language/tagger.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/speech/known_kitchen.h"

namespace engram::speech {
namespace {

class TaggerOfKitchen : public testing::KnownKitchen {
 protected:
  void SetUp() override {
    KnownKitchen::SetUp();
    lexicon_ = std::make_unique<Lexicon>(*facts_);
  }

  std::vector<TaggedWord> tagged(std::string_view question) {
    auto words = split_words(question);
    EXPECT_OK(words);
    if (!words.ok()) return {};
    tagger_->correct(*words, *lexicon_);
    return tagger_->tag(*words, *lexicon_);
  }

  /// The tag of the word with this text; kUnknown where there is none.
  WordTag tag_of(std::string_view question, std::string_view text) {
    for (const TaggedWord& word : tagged(question))
      if (word.text == text) return word.tag;
    ADD_FAILURE() << "'" << text << "' is no word of '" << question << "'";
    return WordTag::kUnknown;
  }

  std::unique_ptr<Lexicon> lexicon_;
  std::unique_ptr<Tagger> tagger_ = make_word_tagger();
};

TEST_F(TaggerOfKitchen, KnowsTheNamesOfTheMemory) {
  EXPECT_EQ(tag_of("Where is the salt?", "salt"), WordTag::kThing);
  EXPECT_EQ(tag_of("What is on the table?", "table"), WordTag::kPlace);
  EXPECT_EQ(tag_of("What did Ada say?", "ada"), WordTag::kPerson);
  EXPECT_EQ(tag_of("Where is the violin?", "violin"), WordTag::kUnknown);
}

TEST_F(TaggerOfKitchen, CorrectsALetterButNoNames) {
  EXPECT_EQ(tag_of("When did you garsp it?", "grasp"), WordTag::kVerb);
  EXPECT_EQ(tag_of("Where is the bread?", "bread"), WordTag::kUnknown);
}

TEST_F(TaggerOfKitchen, TellsHandsFromOtherMeanings) {
  EXPECT_EQ(tag_of("Did you use the left hand?", "left"), WordTag::kHand);
  EXPECT_NE(tag_of("Have you left the table?", "left"), WordTag::kHand);
}

TEST_F(TaggerOfKitchen, TellsDrivesFromOtherWaysOfGoing) {
  EXPECT_EQ(tag_of("Did you go to the table?", "go"), WordTag::kVerb);
  EXPECT_NE(tag_of("How much time went by?", "went"), WordTag::kVerb);
  EXPECT_NE(tag_of("What did you go and take?", "go"), WordTag::kVerb);
  EXPECT_NE(tag_of("Which action came first?", "came"), WordTag::kVerb);
}

TEST_F(TaggerOfKitchen, TakesNoTasksForGrasps) {
  EXPECT_EQ(tag_of("Where did you get the salt?", "get"), WordTag::kVerb);
  EXPECT_NE(tag_of("Which tasks did you get?", "get"), WordTag::kVerb);
}

}  // namespace
}  // namespace engram::speech
