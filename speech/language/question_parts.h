// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what rules of the grammar look at.

#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "speech/language/tagger.h"
#include "speech/language/time_words.h"
#include "speech/program/program.h"

namespace engram::speech {

/// What is asked for.
enum class Asks {
  kNothing,
  kWhere,
  kWhen,
  kWho,
  kWhy,
  kHowLong,
  kHowFar,
  kHowOften,
  kHowMany,
  kHowAgo,
  kWhich,
  kWhat,
  kHow,
  kWhether,
};

/// The words of one clause, sorted by what they are.
struct ClauseParts {
  std::vector<TaggedWord> words;
  std::set<std::string> lemmas;     ///< Of all words, names excepted.
  std::vector<std::string> things;  ///< As programs name them, in the order of the words.
  std::vector<std::string> places;
  std::vector<std::string> persons;
  std::vector<std::string> hands;
  std::vector<const TaggedWord*> verbs;  ///< Of skills.
  std::vector<std::string> skills;       ///< Skills that are called by their names.

  explicit ClauseParts(std::vector<TaggedWord> of);
  ClauseParts(const ClauseParts& other) : ClauseParts(other.words) {}
  ClauseParts& operator=(const ClauseParts&) = delete;

  [[nodiscard]] bool has(std::string_view lemma) const {
    return lemmas.contains(std::string(lemma));
  }
  [[nodiscard]] bool has_any(std::initializer_list<std::string_view> any) const;
  /// Whether these words follow each other.
  [[nodiscard]] bool has_words(std::initializer_list<std::string_view> row) const;
  [[nodiscard]] bool has_verb() const { return !verbs.empty() || !skills.empty(); }
};

/// How a subordinate clause limits the time of the main one.
enum class ClauseLink { kAfter, kBefore, kWhile };

struct SubordinateClause {
  ClauseLink link{};
  bool is_since = false;  ///< "Since" asks how long ago, and "after" does not.
  ClauseParts parts;
};

/// A question in parts.
struct QuestionParts {
  Asks asks = Asks::kNothing;
  ClauseParts main;
  std::optional<SubordinateClause> beside;
  std::set<std::string> context;         ///< Things of the sentences before, for "it" and "that".
  std::set<std::string> context_lemmas;  ///< What they tell of: "Suppose you had not stopped."
  std::vector<TaggedWord> told;          ///< The words of the sentences before and after.
  AskedTimes times;

  QuestionParts(Asks asked, ClauseParts clause) : asks(asked), main(std::move(clause)) {}
};

/// Where a clause begins behind words such as "so" and "well", which ask nothing. The last word
/// counts, whatever it is. The clause must not be empty.
[[nodiscard]] size_t begin_of_asking(const std::vector<TaggedWord>& words);

/// Finds the sentence that asks, what it asks for, and its clauses. `is_indirect`: it followed
/// "tell me" or the like.
[[nodiscard]] QuestionParts parts_of_question(const std::vector<TaggedWord>& words,
                                              AskedTimes times, bool is_indirect);

}  // namespace engram::speech
