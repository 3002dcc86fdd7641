// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the rules of the grammar, one group per file.

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "speech/language/lexicon.h"
#include "speech/language/question_parts.h"
#include "speech/program/filter_texts.h"
#include "speech/program/program.h"

namespace engram::speech {

/// What rules read a question with.
///
/// Threading: one thread.
class GrammarRules {
 public:
  GrammarRules(const QuestionParts& parts, const Lexicon& lexicon)
      : parts_(parts), main_(parts.main), lexicon_(lexicon) {}

  /// The program of the first rule that fits; nothing where none does, or where it does not say all
  /// that the question says.
  std::optional<Program> program();

 private:
  using Found = std::optional<Program>;

  // What no program tells, and whether a program says what the question says (soundness.cpp).
  [[nodiscard]] bool is_beyond_programs() const;
  [[nodiscard]] bool says_all(const Program& program) const;
  [[nodiscard]] bool names_are_said(const Program& program) const;
  [[nodiscard]] bool is_of_who_is_asked(const Program& program) const;
  [[nodiscard]] bool bounds_are_said(const Program& program) const;
  [[nodiscard]] bool endings_are_said(const Program& program) const;
  [[nodiscard]] bool verbs_are_said(const Program& program) const;

  // What would have been (rules_of_instead.cpp).
  Found unfinished();
  Found instead();
  [[nodiscard]] std::string skills_that_would_be() const;
  /// Whether the sentences before the question tell of one of these.
  [[nodiscard]] bool context_has(std::initializer_list<std::string_view> lemmas) const;
  [[nodiscard]] bool context_tells_stop() const;

  // What no other words mean: plans, and the same hand (rules_of_plans.cpp).
  Found planned();
  Found same_hand();

  // Who, why and when (rules_of_events.cpp).
  Found who();
  Found why();
  Found when();

  // How much, which and what (rules_of_actions.cpp).
  Found amounts();
  Found how_long();
  Found how_far();
  Found how_many_words();
  Found how_many_things();
  Found which();
  Found which_hand();
  Found what();
  Found what_at_ends();
  Found what_was_said();
  Found what_was_done(bool is_narration);

  // Where things and the robot are, and what is seen (rules_of_things.cpp).
  Found where();
  Found where_before();
  Found where_when_seen();
  Found where_gone();
  Found where_done(const std::string& skills);
  Found holding();
  Found on_place();
  Found seeing();
  Found coloured();
  Found robot_at();

  // Yes or no (rules_of_yes_no.cpp).
  Found compared();
  Found compared_persons();
  Found compared_skills();
  Found whether();
  Found whether_failed();
  Found whether_asked();
  Found whether_of_thing();
  Found whether_held(bool is_of_empty_hand);
  Found whether_seen(bool is_anything);

  /// The executions that the words select: skill, thing, place, hand, person, time.
  [[nodiscard]] Program executions() const;
  /// The same of one clause, without times.
  [[nodiscard]] Program executions_of(const ClauseParts& clause) const;
  /// The skills that the verbs of a clause mean, joined by commas; empty: it has none.
  [[nodiscard]] std::string skills_of(const ClauseParts& clause) const;
  /// The skills by which a thing is carried, for a verb such as "bring" or "move"; nothing: it
  /// means what else it says.
  [[nodiscard]] std::optional<std::vector<std::string>> carrying_skills(
      const ClauseParts& clause, std::string_view lemma) const;
  /// The skills of the memory that verbs of English name, joined by commas: "pick".
  [[nodiscard]] std::string skills_called(std::initializer_list<std::string_view> verbs) const;
  /// Adds these skills, where the memory has any.
  void add_skills(Program& program, std::initializer_list<std::string_view> verbs) const;
  /// Adds the times, and the time that a subordinate clause tells.
  void add_times(Program& program) const;
  /// The times in which a thing was seen.
  void add_sight_times(Program& program) const;
  /// The moment as `at`, for things and the robot: a span counts by its end.
  void add_moment(Program& program) const;
  /// The program of what a subordinate clause tells; its last step is when or ended.
  [[nodiscard]] Found moment_of_clause() const;
  /// Adds first, last or nth, as the words say; else the one that is given.
  void add_order(Program& program, std::optional<StepKind> otherwise) const;
  [[nodiscard]] bool has_order() const;
  /// Whether a word stands there in this very form: "second", and not "seconds".
  [[nodiscard]] bool has_text(std::string_view text) const {
    return std::any_of(main_.words.begin(), main_.words.end(),
                       [&](const TaggedWord& word) { return word.text == text; });
  }
  /// Whether the longest or the shortest is asked for.
  [[nodiscard]] bool is_superlative() const {
    return main_.has_any({"longest", "shortest", "slowest", "quickest", "fastest"});
  }

  /// Whether the present is asked about: "What are you doing?"
  [[nodiscard]] bool is_of_present() const;
  /// Whether a hand is asked for: "which hand", "which of your arms", "left or right".
  [[nodiscard]] bool asks_for_hand() const;
  [[nodiscard]] bool asks_about_failure() const;
  [[nodiscard]] bool asks_about_stop() const;
  [[nodiscard]] bool asks_about_sight() const;
  [[nodiscard]] bool asks_about_words() const;
  [[nodiscard]] bool asks_about_holding() const;
  [[nodiscard]] bool asks_about_attempts() const;
  [[nodiscard]] bool asks_about_success() const;
  /// Whether the robot is meant: "you".
  [[nodiscard]] bool is_of_robot() const { return main_.has_any({"you", "robot", "yourself"}); }
  /// The thing of the words, or of the sentence before where the words say "it"; empty: none.
  [[nodiscard]] std::string thing() const;
  void add_thing(Program& program) const;
  void add_places(Program& program) const;

  const QuestionParts& parts_;
  const ClauseParts& main_;
  const Lexicon& lexicon_;
};

}  // namespace engram::speech
