// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "speech/language/lexicon.h"
#include "speech/language/words.h"
#include "speech/program/skill_verbs.h"

namespace engram::speech {

/// What a word, or several that are one name, is in a question.
enum class WordTag {
  kThing,
  kPlace,
  kPerson,
  kHand,
  kSkill,    ///< A skill by its name.
  kVerb,     ///< A verb that English has for skills.
  kGrammar,  ///< A word that rules of the grammar look at.
  kFiller,   ///< A word that nothing depends on.
  kUnknown,  ///< A word that neither the memory nor the grammar knows.
};

struct TaggedWord {
  WordTag tag = WordTag::kUnknown;
  std::string text;   ///< As it was corrected.
  std::string lemma;  ///< Its base form.
  std::string value;  ///< Of a name: as programs name it.
  const SkillVerb* verb = nullptr;
  bool begins_sentence = false;
  bool ends_clause = false;
  bool is_capital = false;
  bool is_corrected = false;  ///< It was mistyped.
};

/// Says what each word of a question is.
///
/// Threading: const-parallel.
class Tagger {
 public:
  virtual ~Tagger() = default;

  /// Puts what was meant in place of words that are mistyped. It comes before all else.
  virtual void correct(std::vector<QuestionWord>& words, const Lexicon& lexicon) const = 0;

  /// Words come without those that told of times, and with phrases replaced
  /// (speech/language/question_phrases.h).
  [[nodiscard]] virtual std::vector<TaggedWord> tag(const std::vector<QuestionWord>& words,
                                                    const Lexicon& lexicon) const = 0;
};

/// The verb that has this base form; null: none.
[[nodiscard]] const SkillVerb* verb_with_lemma(std::string_view lemma);

/// A tagger of word lists and of the names that a memory has. It corrects what is one letter off:
/// in longer words, and more carefully where a name may stand, because "bread" is no "break".
[[nodiscard]] std::unique_ptr<Tagger> make_word_tagger();

}  // namespace engram::speech
