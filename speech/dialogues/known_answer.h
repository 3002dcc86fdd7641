// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: questions without words, with what is true of them.

#include <deque>
#include <map>
#include <string>
#include <vector>

#include "speech/dialogues/lived_past.h"
#include "speech/facts/answer_value.h"

namespace engram::speech::dialogues {

/// The families of questions, in the order in which reports list them.
inline constexpr const char* kFamilies[] = {"objects",       "events",    "explanations",
                                            "action_detail", "at_a_time", "problems",
                                            "unanswerable",  "what_if"};

/// What is asked, apart from any wording. Empty members are not asked for.
struct Asked {
  std::string what;     ///< "where_now", "how_often", ...: which phrasings fit.
  std::string skill;    ///< "pick", "place", "navigate", "look" or "any".
  std::string outcome;  ///< "success", "failure", "stop" or "any" where the words must say it.
  std::string which;    ///< "first" or "last", where the words must say it.
  /// "all", "now", "{time}", "{ago}", "{day}", or how a span of time is put: "since_{time}".
  std::string when = "all";
  std::string thing;
  std::string place;
};

/// The same, but for what is asked.
[[nodiscard]] Asked asked_of(Asked base, const char* what);

/// A question with its true answer.
struct KnownAnswer {
  std::string family;
  Asked asked;
  /// What the words mention beside thing and place: "time", "ago", "day", "when", "thing2", ...
  std::map<std::string, std::string> slots{};
  Time now{};  ///< When it is asked.
  AnswerValue value{};
  std::vector<AnswerValue> also{};  ///< Other values that are as right.
  /// An answer must show at least one of these. Empty: nothing shows that nothing happened.
  std::vector<ltm::MemoryId> evidence{};
};

/// Everything that can be asked of a past at a moment, and is neither ambiguous nor at the edge of
/// something: where a second sooner or later changed the answer, nothing is asked.
///
/// Equal arguments give equal answers in an equal order; `seed` chooses the times that are asked
/// about.
[[nodiscard]] std::deque<KnownAnswer> known_answers(const LivedPast& past, Time now, uint64_t seed);

using Actions = std::vector<const LivedAction*>;

/// Parts of known_answers(). Each adds to `known`.
struct AnswerList {
  const LivedPast& past;
  Time now{};
  std::deque<KnownAnswer>& known;

  /// Adds a question of `family`. The reference stays valid.
  KnownAnswer& add(const char* family, Asked asked, AnswerValue value,
                   std::vector<ltm::MemoryId> evidence) const;
  void add_unknown(const char* why, Asked asked,
                   std::map<std::string, std::string> slots = {}) const;

  /// Whether the last recording goes on at the moment of the question, so that "now" has a meaning.
  [[nodiscard]] bool is_present() const;
  /// The names of the things that were seen, in order.
  [[nodiscard]] std::vector<std::string> things() const;
  /// The executions of a skill ("any": of all) with a thing and at a place; empty
  /// names fit all.
  [[nodiscard]] Actions actions(const std::string& skill, const std::string& thing = {},
                                const std::string& place = {}) const;
};

void add_object_answers(const AnswerList& list);
void add_event_answers(const AnswerList& list, uint64_t seed);
void add_task_answers(const AnswerList& list);
void add_reason_answers(const AnswerList& list);
void add_detail_answers(const AnswerList& list);
void add_moment_answers(const AnswerList& list, uint64_t seed);
void add_problem_answers(const AnswerList& list);
void add_unknown_answers(const AnswerList& list, uint64_t seed);
void add_instead_answers(const AnswerList& list);

[[nodiscard]] std::vector<ltm::MemoryId> begun_ids(const Actions& actions);
[[nodiscard]] std::vector<ltm::MemoryId> over_ids(const Actions& actions);
[[nodiscard]] std::vector<ltm::MemoryId> all_ids(const Actions& actions);
[[nodiscard]] AnswerValue events_of(const Actions& actions);
/// The actions with this outcome.
[[nodiscard]] Actions with_outcome(const Actions& actions, const std::string& outcome);
/// Nothing failed, was stopped or went on when the recording ended.
[[nodiscard]] bool are_all_done(const Actions& actions);

/// Times as people say them: "8:00:12", "January 2".
[[nodiscard]] std::string clock_words(Time time);
[[nodiscard]] std::string day_words(Time time);
[[nodiscard]] Time day_of(Time time);

}  // namespace engram::speech::dialogues
