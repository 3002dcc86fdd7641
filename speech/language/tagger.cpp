// SPDX-License-Identifier: Apache-2.0
#include "speech/language/tagger.h"

#include <algorithm>

#include "speech/language/english.h"

namespace engram::speech {

const SkillVerb* verb_with_lemma(std::string_view lemma) {
  for (const SkillVerb& verb : skill_verbs())
    if (has_lemma(verb, lemma)) return &verb;
  return nullptr;
}

namespace {

/// Correcting costs a comparison with all words that are known.
constexpr size_t kMaxCorrections = 12;
constexpr size_t kMinCorrected = 5;

bool is_determiner(const std::string& word) {
  return is_article(word) || is_any(word, {"no", "every"});
}

bool is_preposition(const std::string& word) {
  return is_any(word,
                {"in", "on", "at",   "to",   "from", "into", "onto",  "with",   "of",     "for",
                 "by", "up", "down", "near", "off",  "over", "about", "beside", "behind", "under"});
}

bool has_digit(const std::string& word) {
  return word.find_first_of("0123456789") != std::string::npos;
}

bool has_same_letters(std::string a, std::string b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  return a == b;
}

/// To find and to spot is to see, and to drop is no way of placing.
bool is_no_deed(const std::string& lemma) {
  return is_any(lemma, {"find", "spot", "locate", "watch", "scan", "drop"});
}

class WordTagger final : public Tagger {
 public:
  [[nodiscard]] std::vector<TaggedWord> tag(const std::vector<QuestionWord>& words,
                                            const Lexicon& lexicon) const override {
    std::vector<TaggedWord> tagged;
    for (size_t at = 0; at < words.size();) {
      TaggedWord word = name_at(words, at, lexicon);
      size_t count =
          word.text.empty()
              ? 0
              : 1 + static_cast<size_t>(std::count(word.text.begin(), word.text.end(), ' '));
      if (count == 0) {
        word = word_at(words, at);
        count = 1;
      }
      word.begins_sentence = words[at].begins_sentence;
      word.is_capital = words[at].is_capital;
      word.ends_clause = words[at + count - 1].ends_clause;
      for (size_t i = at; i < at + count; ++i) word.is_corrected |= words[i].is_corrected;
      tagged.push_back(std::move(word));
      at += count;
    }
    return tagged;
  }

  void correct(std::vector<QuestionWord>& words, const Lexicon& lexicon) const override {
    size_t corrections = 0;
    for (size_t at = 0; at < words.size(); ++at) {
      std::string& word = words[at].text;
      if (is_known(word, lexicon) || word.size() < kMinCorrected - 1 ||
          corrections == kMaxCorrections)
        continue;
      ++corrections;
      const std::string better = correction(word, may_be_name(words, at), lexicon);
      if (better.empty()) continue;
      word = better;
      words[at].is_corrected = true;
    }
  }

 private:
  static bool is_known(const std::string& word, const Lexicon& lexicon) {
    return lexicon.words().contains(word) || is_filler(word) || is_filler(lemma_of(word)) ||
           is_grammar_lemma(lemma_of(word)) || is_grammar_lemma(word) ||
           lexicon.words().contains(lemma_of(word)) || number_named(word) >= 0 || has_digit(word) ||
           word.find('_') != std::string::npos;
  }

  /// Whether a name may stand at this word.
  static bool may_be_name(const std::vector<QuestionWord>& words, size_t at) {
    if (words[at].is_capital && !words[at].begins_sentence) return true;
    if (at == 0) return false;
    const std::string& before = words[at - 1].text;
    const std::string lemma = lemma_of(before);
    return is_determiner(before) || is_preposition(before) || verb_with_lemma(lemma) != nullptr ||
           is_any(lemma, {"see", "hold", "carry", "have", "touch", "bring", "want", "and", "or",
                          "many", "much", "what", "which", "whose"});
  }

  /// The known word that is meant; empty: none is.
  static std::string correction(const std::string& word, bool is_name, const Lexicon& lexicon) {
    for (const std::string& name : lexicon.words()) {
      if (name.size() + 1 < kMinCorrected) continue;
      // In short words only two letters that changed places: "silk" is no "milk".
      const bool is_long = word.size() >= kMinCorrected && name.size() >= kMinCorrected;
      if (is_long ? letters_apart(word, name, 1) == 1
                  : has_same_letters(word, name) && letters_apart(word, name, 1) == 1)
        return name;
    }
    if (word.size() < kMinCorrected) {
      for (const std::string& known : english_spellings())
        if (known.size() == word.size() && has_same_letters(word, known) &&
            letters_apart(word, known, 1) == 1)
          return known;
      return {};
    }
    std::string best;
    int best_apart = word.size() >= 9 ? 3 : 2;
    for (const std::string& known : english_spellings()) {
      if (known.size() + 1 < kMinCorrected) continue;
      // Letters that changed places are the likeliest mistake: "hanlding" is no "handing".
      const bool is_swapped = has_same_letters(word, known);
      const int apart = letters_apart(word, known, best_apart);
      if (apart > best_apart || (apart == best_apart && (best.empty() || !is_swapped))) continue;
      // Where a name may stand, a letter that is another one makes another name.
      const bool is_sure =
          is_swapped || (word.size() >= 6 && known.size() >= 6 && word.size() != known.size());
      if (is_name && !is_sure) continue;
      best = known;
      best_apart = apart;
    }
    return best;
  }

  /// The longest name that begins here; without text where there is none.
  static TaggedWord name_at(const std::vector<QuestionWord>& words, size_t at,
                            const Lexicon& lexicon) {
    TaggedWord found;
    std::string joined;
    for (size_t count = 1; count <= Lexicon::kMaxWordsOfName && at + count <= words.size();
         ++count) {
      const std::string& last = words[at + count - 1].text;
      const std::string before = joined.empty() ? "" : joined + " ";
      const LexiconName* name = lexicon.find(before + last);
      // "cups" are of what is called "cup".
      if (name == nullptr && last.size() > 3 && last.back() == 's')
        name = lexicon.find(before + last.substr(0, last.size() - 1));
      joined = before + last;
      if (name == nullptr || !is_meant(*name, words, at, count)) continue;
      found.text = joined;
      found.lemma = joined;
      found.value = name->value;
      found.tag = tag_of(name->kind);
      if (words[at + count - 1].ends_clause) break;
    }
    return found;
  }

  static WordTag tag_of(NameKind kind) {
    switch (kind) {
      case NameKind::kThing:
        return WordTag::kThing;
      case NameKind::kPlace:
        return WordTag::kPlace;
      case NameKind::kPerson:
        return WordTag::kPerson;
      case NameKind::kHand:
        return WordTag::kHand;
      case NameKind::kSkill:
        break;
    }
    return WordTag::kSkill;
  }

  /// Hands are called by words that have other meanings: "left" is of leaving, "right now" is now.
  static bool is_meant(const LexiconName& name, const std::vector<QuestionWord>& words, size_t at,
                       size_t count) {
    const std::string after = at + count < words.size() ? words[at + count].text : "";
    const std::string before = at > 0 ? words[at - 1].text : "";
    if (name.kind != NameKind::kHand)
      return count > 1 || words[at].is_capital ||
             !(is_any(words[at].text, {"can", "will", "may", "mark", "might", "place", "thing"}));
    if (is_any(after, {"hand", "arm", "gripper", "side", "one", "or"})) return true;
    if (is_any(after, {"after", "before", "now", "then", "when", "away"})) return false;
    return is_any(before, {"the", "your", "my", "or", "with", "its", "hand", "use", "used"});
  }

  static TaggedWord word_at(const std::vector<QuestionWord>& words, size_t at) {
    TaggedWord word;
    word.text = words[at].text;
    word.lemma = lemma_of(word.text);
    const std::string after = at + 1 < words.size() ? words[at + 1].text : "";
    const std::string before = at > 0 ? words[at - 1].text : "";
    if (word.text == "left" && is_any(before, {"you", "have", "was", "been", "robot", "did"}))
      word.lemma = "leave";
    const SkillVerb* verb = verb_with_lemma(word.lemma);
    if (verb != nullptr && !is_no_deed(word.lemma) && is_verb_here(word, before, after) &&
        (!is_any(word.lemma, {"go", "come"}) || is_of_moving(words, at)) &&
        (word.lemma != "get" || is_of_getting(words, at))) {
      word.tag = WordTag::kVerb;
      word.verb = verb;
      return word;
    }
    if (is_grammar_lemma(word.lemma) || word.text.find('_') != std::string::npos ||
        is_grammar_lemma(word.text))
      word.tag = WordTag::kGrammar;
    else if (is_filler(word.text) || is_filler(word.lemma) || number_named(word.text) >= 0)
      word.tag = WordTag::kFiller;
    return word;
  }

  /// Whether to go or to come is to drive: "went to the table", "go there", and not "went to take
  /// it", "came first", "how much time went by".
  static bool is_of_moving(const std::vector<QuestionWord>& words, size_t at) {
    const auto text = [&](size_t index) {
      return index < words.size() ? words[index].text : std::string();
    };
    if (words[at].ends_clause || at + 1 == words.size()) return true;
    size_t next = at + 1;
    while (is_any(text(next), {"over", "back", "across", "straight", "all", "the", "way", "right"}))
      ++next;
    if (is_any(text(next), {"and"})) return false;
    const bool is_driving =
        lemma_of(words[at].text) == "go" || is_any(text(next), {"to", "near", "there", "here"});
    if (text(next) == "to" && next + 1 < words.size()) {
      const std::string lemma = lemma_of(text(next + 1));
      if (lemma == text(next + 1) && lemma != "place" && verb_with_lemma(lemma) != nullptr)
        return false;
    }
    const bool is_gerund =
        text(next).ends_with("ing") && verb_with_lemma(lemma_of(text(next))) != nullptr;
    return is_driving && !is_gerund &&
           !is_any(text(next), {"by", "off", "into", "ahead", "after", "through", "wrong", "for"});
  }

  /// Whether to get is to take: not "get your tasks", "where has it got to".
  static bool is_of_getting(const std::vector<QuestionWord>& words, size_t at) {
    const bool is_of_task = std::any_of(words.begin(), words.end(), [](const QuestionWord& word) {
      return is_any(lemma_of(word.text),
                    {"task", "job", "order", "command", "request", "instruction"});
    });
    if (is_of_task) return false;
    if (words[at].text == "got" && at > 0 &&
        !is_any(words[at - 1].text, {"you", "have", "robot", "i", "and", "has", "ever", "not"}))
      return false;
    return !(at + 2 == words.size() && words[at + 1].text == "to");
  }

  /// Whether a word that may be a verb is one: "the first place" and "went wrong" have none.
  static bool is_verb_here(const TaggedWord& word, const std::string& before,
                           const std::string& after) {
    if (word.lemma == "go" && is_any(after, {"wrong", "well", "smoothly", "fine", "on", "badly",
                                             "amiss", "as", "according"}))
      return false;
    // "Why did going to the table fail?" is of a drive, "Are you going to pick it up?" of none.
    if (word.text == "going" && after == "to" &&
        is_any(before, {"you", "robot", "are", "is", "were", "was", "not", "am", "be"}))
      return false;
    if (word.text == "left" && after == "to") return false;
    if (word.text == "lay" && is_any(before, {"what", "that", "things", "objects", "items"}))
      return false;
    if (word.lemma == "get" && after.empty()) return false;
    if (word.lemma == "look" && after == "like") return false;
    if (word.lemma == "get" && is_any(after, {"done", "stopped", "interrupted", "asked", "told",
                                              "wrong", "stuck", "lost", "blocked"}))
      return false;
    if (word.lemma == "come" && is_any(after, {"up", "from", "with"}) && before != "you")
      return false;
    if (is_any(word.text, {"place", "grip", "visit", "search", "walk", "look", "set"}) &&
        is_any(before, {"which", "what", "that", "same", "whose", "any", "some"}))
      return false;
    if (word.text == "place" && is_any(before, {"the", "a", "take", "took", "taking", "taken"}))
      return false;
    if (is_any(word.lemma, {"give", "pass", "fill", "clean", "close", "press"}))
      return is_any(before, {"you", "to", "robot", "did", "and", "i", "have", "by", "were"});
    return true;
  }
};

}  // namespace

std::unique_ptr<Tagger> make_word_tagger() {
  return std::make_unique<WordTagger>();
}

}  // namespace engram::speech
