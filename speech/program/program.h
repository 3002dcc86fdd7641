// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/core/status.h"

namespace engram::speech {

/// What a program asks about.
enum class ProgramSource {
  kExecutions,  ///< What the robot did.
  kWords,       ///< What was said.
  kPlans,       ///< What the robot meant to do.
  kRefusals,    ///< What it was asked for and did not begin.
  kDrives,      ///< What happened to drives around obstacles.
  kThings,      ///< How things are at a moment.
  kRobot,       ///< Where the robot is at a moment.
};

/// What is known of each record that a filter keeps.
enum class FilterKey {
  kSkill,    ///< pick, or robot/pick; several are separated by commas.
  kThing,    ///< The name of a thing, or its entity.
  kPlace,    ///< The name of a place, or its entity.
  kHand,     ///< The hand that did it, or that holds the thing.
  kOutcome,  ///< running, success, failure, stop, lost, or problem: failure or stop.
  kSpeaker,  ///< Who said it, or whose words caused it.
  kText,     ///< A part of what was said, of a goal or of a reason; case does not count.
  kKind,     ///< Of what happened to a drive: blocked, replanned, ...
  kIsHeld,   ///< Whether a hand holds the thing: yes or no.
  kVisible,  ///< Whether the thing is in sight: yes or no.
  kDuring,   ///< It began within this time.
  kAt,       ///< It went on at this time; of a thing or the robot: when.
  kAfter,    ///< It began after this.
  kBefore,   ///< It began before this.
};

/// What is done with the records that the filters keep, or with what the step before made of them.
enum class StepKind {
  // One record of several.
  kFirst,
  kLast,
  kNth,  ///< nth=2 is the second.
  kLongest,
  kShortest,
  kPrevious,   ///< The execution before the first of these,
  kNext,       ///< and the one after the last of these.
  kFirstSeen,  ///< The state of the thing when it was first in sight,
  kLastSeen,   ///< and when it was last in sight.
  // A value.
  kCount,
  kExists,
  kNone,     ///< Whether there are none.
  kHowMany,  ///< how_many=thing counts different things, hands, skills, places, persons or colours;
             ///< how_many=step the steps of plans.
  kEvents,
  kWhen,
  kAgo,  ///< How long that is ago.
  kEnded,
  kSpan,
  kHowLong,
  kHowFar,
  kWhere,
  kFrom,          ///< The place where it began.
  kWho,           ///< Whose words these are, or caused this.
  kWhoStopped,    ///< Whose words stopped it.
  kWhich,         ///< which=thing, hand, skill, place, person or colour.
  kSaid,          ///< The words, or those that caused this.
  kWhy,           ///< What caused it, by its links.
  kReason,        ///< Why it ended as it did.
  kSucceeded,     ///< Whether it did what it was to do.
  kRetried,       ///< Whether the same was tried again afterwards.
  kInstead,       ///< The skills of the steps of its plan that had not begun when it ended,
  kInsteadNext,   ///< that of the first of them,
  kInsteadWhere,  ///< the place of the last one,
  kInsteadHas,    ///< instead_has=place: whether one of them has this skill.
  kHolder,
  kIsVisible,
  kWasMoved,  ///< Whether the thing was ever elsewhere than at first.
  // The value, compared with that of another program.
  kMoreThan,
  kLessThan,
  kEquals,
};

struct Program;

/// The value of a filter or a step: a text, or a program in parentheses.
struct Argument {
  std::string text;
  std::shared_ptr<const Program> program;  ///< Null: it is a text.

  friend bool operator==(const Argument& a, const Argument& b);
};

struct ProgramFilter {
  FilterKey key{};
  Argument value;
  friend bool operator==(const ProgramFilter&, const ProgramFilter&) = default;
};

struct ProgramStep {
  StepKind kind{};
  std::optional<Argument> argument{};
  friend bool operator==(const ProgramStep&, const ProgramStep&) = default;
};

/// A question in the language of programs: a source, filters, and steps one after the other.
///
///     executions skill=pick thing=salt outcome=failure during=yesterday | last | why
///     things thing="red cup" | last_seen | where
///     executions skill=pick after=(executions skill=place thing=tea | last | ended) | first | when
///
/// Source: docs/verbalisation.md, section "The language of programs".
struct Program {
  static constexpr size_t kMaxTextBytes = 4096;
  static constexpr size_t kMaxParts = 32;  ///< Of filters, and of steps.
  static constexpr int kMaxDepth = 4;      ///< Of programs in programs.

  ProgramSource source{};
  std::vector<ProgramFilter> filters{};
  std::vector<ProgramStep> steps{};

  /// Reads the text form, and validates it.
  /// Errors: kInvalidArgument naming the position, what was found and what was needed.
  static Result<Program> parse(std::string_view text);

  /// Reads what to_json() wrote, and validates it; safe on hostile values.
  /// Errors: kInvalidArgument.
  static Result<Program> from_json(const nlohmann::ordered_json& json);

  /// Whether each filter fits its source, each value its filter, and each step what the one before
  /// it makes.
  /// Errors: kInvalidArgument naming the part that does not fit and what was needed.
  [[nodiscard]] Status validate() const;

  /// A text that parse() reads to the same program.
  [[nodiscard]] std::string to_string() const;
  /// Returns {"source", "filters": {name: text or program}, "steps": [name or {name: argument}]}.
  [[nodiscard]] nlohmann::ordered_json to_json() const;

  /// The value of the filter with this key; null where there is none.
  [[nodiscard]] const Argument* find(FilterKey key) const;
  [[nodiscard]] bool has_step(StepKind kind) const;

  Program& with(FilterKey key, std::string text);
  Program& then(StepKind kind);
  Program& then(StepKind kind, std::string argument);

  friend bool operator==(const Program&, const Program&) = default;
};

/// The words of the text form.
[[nodiscard]] std::string_view name_of(ProgramSource source);
[[nodiscard]] std::string_view name_of(FilterKey key);
[[nodiscard]] std::string_view name_of(StepKind kind);
[[nodiscard]] std::optional<ProgramSource> source_named(std::string_view name);
[[nodiscard]] std::optional<FilterKey> filter_named(std::string_view name);
[[nodiscard]] std::optional<StepKind> step_named(std::string_view name);

}  // namespace engram::speech
