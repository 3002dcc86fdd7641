// SPDX-License-Identifier: Apache-2.0
#include "speech/attention/asked_names.h"

#include <algorithm>

namespace engram::speech {

namespace {

void add_once(std::vector<std::string>& all, const std::string& name) {
  if (!name.empty() && std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
}

size_t place_among(const std::vector<std::string>& all, const std::string& name) {
  return static_cast<size_t>(std::find(all.begin(), all.end(), name) - all.begin());
}

/// A number for a part of a word, the same on every machine (FNV-1a).
int32_t number_of(std::string_view kind, std::string_view text) {
  uint64_t hash = 0xCBF29CE484222325;
  for (const std::string_view part : {kind, text})
    for (const char c : part) {
      hash ^= static_cast<unsigned char>(c);
      hash *= 0x100000001B3;
    }
  return 1 + static_cast<int32_t>((hash >> 20) % (AttentionInput::kParts - 1));
}

/// The parts of one word; those that are too many are left out.
class WordParts {
 public:
  void add(std::string_view kind, std::string_view text) {
    if (count_ < AttentionInput::kPartsPerWord) word_[count_++] = number_of(kind, text);
  }
  void add_letters(const std::string& text) {
    const std::string framed = "<" + text + ">";
    for (size_t at = 0; at + 3 <= framed.size(); ++at) add("3:", framed.substr(at, 3));
  }
  [[nodiscard]] const AttentionInput::Word& word() const { return word_; }

 private:
  AttentionInput::Word word_{};
  size_t count_ = 0;
};

AttentionInput::Word numbers_of(const TaggedWord& word, const AskedNames& names) {
  WordParts parts;
  const auto add_name = [&](std::string_view kind, const std::vector<std::string>& all) {
    parts.add("kind:", kind);
    parts.add(kind, std::to_string(std::min<size_t>(place_among(all, word.value), 3)));
  };
  switch (word.tag) {
    case WordTag::kThing:
      add_name("thing", names.things);
      break;
    case WordTag::kPlace:
      add_name("place", names.places);
      break;
    case WordTag::kPerson:
      add_name("person", names.persons);
      break;
    case WordTag::kHand:
      add_name("hand", names.hands);
      break;
    case WordTag::kSkill:
      parts.add("kind:", "skill");
      break;
    case WordTag::kVerb:
      if (word.verb != nullptr) parts.add("verb:", word.verb->base);
      [[fallthrough]];
    default:
      parts.add("text:", word.text);
      parts.add("lemma:", word.lemma);
      if (word.tag == WordTag::kUnknown) {
        parts.add("kind:", "unknown");
        parts.add_letters(word.text);
      }
  }
  if (word.ends_clause) parts.add("sign:", ",");
  return parts.word();
}

AttentionInput::Word number_of_time(std::string_view key) {
  WordParts parts;
  parts.add("time:", key);
  return parts.word();
}

}  // namespace

bool is_name(const AttentionInput::Word& word) {
  constexpr std::array kKinds{"thing", "place", "person", "hand", "skill"};
  return std::any_of(kKinds.begin(), kKinds.end(),
                     [&](const char* kind) { return word[0] == number_of("kind:", kind); });
}

AskedNames::AskedNames(const QuestionInWords& question, const Lexicon& lexicon) {
  for (const TaggedWord& word : question.words) {
    if (word.tag == WordTag::kThing) add_once(things, word.value);
    if (word.tag == WordTag::kPlace) add_once(places, word.value);
    if (word.tag == WordTag::kPerson) add_once(persons, word.value);
    if (word.tag == WordTag::kHand) add_once(hands, word.value);
    if (word.tag == WordTag::kSkill) add_once(skills, word.value);
    if (word.verb != nullptr) add_once(skills, lexicon.skills_of(*word.verb));
  }
  for (const SkillVerb& verb : skill_verbs()) skills_of_verbs.push_back(lexicon.skills_of(verb));
}

std::vector<AttentionInput::Word> numbers_of_words(const QuestionInWords& question,
                                                   const AskedNames& names) {
  std::vector<AttentionInput::Word> words;
  for (const TaggedWord& word : question.words) words.push_back(numbers_of(word, names));
  const AskedTimes& times = question.times;
  if (times.during) words.push_back(number_of_time("during"));
  if (times.at) words.push_back(number_of_time("at"));
  if (times.after) words.push_back(number_of_time("after"));
  if (times.before) words.push_back(number_of_time("before"));
  if (times.is_now) words.push_back(number_of_time("now"));
  if (times.is_future) words.push_back(number_of_time("future"));
  return words;
}

}  // namespace engram::speech
