// SPDX-License-Identifier: Apache-2.0
#include "speech/language/lexicon.h"

#include "ltm/core/ascii.h"
#include "speech/language/english.h"

namespace engram::speech {

namespace {

/// Words of a name as a question has them: without signs.
std::vector<std::string> parts_of(const std::string& name) {
  std::vector<std::string> parts;
  std::string part;
  for (const char c : lower_ascii(name) + " ") {
    const bool is_letter =
        (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || static_cast<unsigned char>(c) >= 0x80;
    if (is_letter) part += c;
    if (is_letter || part.empty()) continue;
    parts.push_back(part);
    part.clear();
  }
  return parts;
}

std::string joined_parts(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : " ") + part;
  return text;
}

}  // namespace

Lexicon::Lexicon(const KnownFacts& facts) {
  add_skills(facts);
  add_persons_and_hands(facts);
  // A place and a thing with one name: people mean the place that things are on.
  add_things(facts);
  for (const KnownPlace& place : facts.world().places())
    for (const std::string& name : place.names) add(name, NameKind::kPlace, place.spoken);
}

void Lexicon::add(const std::string& words, NameKind kind, const std::string& value) {
  const auto parts = parts_of(words);
  if (parts.empty() || parts.size() > kMaxWordsOfName) return;
  names_[joined_parts(parts)] = {kind, value};
  words_.insert(parts.begin(), parts.end());
}

/// A thing may be called by its last word, too, where only things of one name have it: "mug".
void Lexicon::add_things(const KnownFacts& facts) {
  std::map<std::string, std::set<std::string>> by_last_word;
  for (const KnownThing& thing : facts.world().things())
    for (const std::string& name : thing.names)
      if (const auto parts = parts_of(name); parts.size() > 1)
        by_last_word[parts.back()].insert(thing.spoken);
  for (const auto& [word, spoken] : by_last_word)
    if (spoken.size() == 1 && !is_filler(word) && !is_grammar_lemma(word))
      add(word, NameKind::kThing, *spoken.begin());
  for (const KnownThing& thing : facts.world().things())
    for (const std::string& name : thing.names) add(name, NameKind::kThing, thing.spoken);
}

void Lexicon::add_persons_and_hands(const KnownFacts& facts) {
  for (const SpokenWords& words : facts.words())
    if (!words.speaker.empty()) add(words.speaker, NameKind::kPerson, words.speaker);
  // A hand that was never used is a hand all the same: these are English words for sides.
  add("left", NameKind::kHand, "left");
  add("right", NameKind::kHand, "right");
  for (const Execution& execution : facts.executions())
    if (!execution.hand.empty()) add(execution.hand, NameKind::kHand, execution.hand);
}

void Lexicon::add_skills(const KnownFacts& facts) {
  for (const std::string& skill : facts.skills()) {
    if (skill.empty() || skill.find(',') != std::string::npos) continue;
    const SkillVerb* verb = verb_of_skill(skill);
    if (verb == nullptr) {
      add(words_of_name(skill), NameKind::kSkill, skill);
      continue;
    }
    std::string& skills = skills_[verb];
    skills += (skills.empty() ? "" : ",") + skill;
  }
}

const LexiconName* Lexicon::find(const std::string& words) const {
  const auto found = names_.find(words);
  return found == names_.end() ? nullptr : &found->second;
}

std::string Lexicon::skills_of(const SkillVerb& verb) const {
  const auto found = skills_.find(&verb);
  return found == skills_.end() ? std::string() : found->second;
}

}  // namespace engram::speech
