// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>

#include "speech/facts/known_facts.h"
#include "speech/program/skill_verbs.h"

namespace engram::speech {

/// What a name of the memory names.
enum class NameKind { kThing, kPlace, kPerson, kHand, kSkill };

/// A name that a memory has, in the words of a question.
struct LexiconName {
  NameKind kind{};
  std::string value;  ///< As programs name it.
};

/// The names that a memory has: things, places, persons, hands, and skills. Nothing of it is known
/// before a memory tells it.
///
/// Threading: const-parallel.
class Lexicon {
 public:
  static constexpr size_t kMaxWordsOfName = 6;

  explicit Lexicon(const KnownFacts& facts);

  /// The name that these words, joined by spaces, are; null: none.
  [[nodiscard]] const LexiconName* find(const std::string& words) const;

  /// All words that are part of names.
  [[nodiscard]] const std::set<std::string>& words() const { return words_; }

  /// The skills that this verb means, joined by commas; empty: the memory has none.
  [[nodiscard]] std::string skills_of(const SkillVerb& verb) const;

 private:
  void add(const std::string& words, NameKind kind, const std::string& value);
  void add_things(const KnownFacts& facts);
  void add_persons_and_hands(const KnownFacts& facts);
  void add_skills(const KnownFacts& facts);

  std::map<std::string, LexiconName> names_;
  std::set<std::string> words_;
  std::map<const SkillVerb*, std::string> skills_;
};

}  // namespace engram::speech
