// SPDX-License-Identifier: Apache-2.0
#include "speech/language/lexicon.h"

#include <gtest/gtest.h>

#include "tests/ltm/expect_status.h"
#include "tests/speech/remembered_kitchen.h"

namespace engram::speech {
namespace {

using testing::RememberedKitchen;

TEST(Lexicon, HasTheNamesThatTheMemoryTells) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const Lexicon lexicon(**facts);
  const LexiconName* salt = lexicon.find("salt");
  ASSERT_NE(salt, nullptr);
  EXPECT_EQ(salt->kind, NameKind::kThing);
  EXPECT_EQ(salt->value, "salt");
  const LexiconName* ada = lexicon.find("ada");
  ASSERT_NE(ada, nullptr);
  EXPECT_EQ(ada->kind, NameKind::kPerson);
  EXPECT_EQ(ada->value, "Ada");
  ASSERT_NE(lexicon.find("table"), nullptr);
  EXPECT_EQ(lexicon.find("table")->kind, NameKind::kPlace);
  EXPECT_EQ(lexicon.find("elephant"), nullptr);
}

TEST(Lexicon, FindsTheSkillsThatAVerbMeans) {
  RememberedKitchen kitchen;
  kitchen.live_one_minute();
  const auto facts = KnownFacts::read(kitchen.memory());
  ASSERT_OK(facts);
  const Lexicon lexicon(**facts);
  EXPECT_EQ(lexicon.skills_of(*verb_of_skill("grasp")), "pick");
  EXPECT_EQ(lexicon.skills_of(*verb_of_skill("pour")), "");
}

TEST(Lexicon, HasNoNamesThatTheMemoryDoesNotHave) {
  const ScratchDirectory scratch;
  auto memory = Memory::open(scratch.path() / "empty.engram");
  ASSERT_OK(memory);
  const auto facts = KnownFacts::read(**memory);
  ASSERT_OK(facts);
  const Lexicon lexicon(**facts);
  for (const char* name : {"salt", "table", "ada", "pick"})
    EXPECT_EQ(lexicon.find(name), nullptr) << name;
  // Sides are English words, whatever a memory has.
  ASSERT_NE(lexicon.find("left"), nullptr);
  EXPECT_EQ(lexicon.find("left")->kind, NameKind::kHand);
  for (const SkillVerb& verb : skill_verbs()) EXPECT_EQ(lexicon.skills_of(verb), "");
}

}  // namespace
}  // namespace engram::speech
