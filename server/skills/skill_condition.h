// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ltm/core/config.h"
#include "ltm/filter/event_rule.h"
#include "ltm/idf/data.h"

namespace engram::skills {

/// What one entity must be like. The keys are those of event rules (docs/recording.md), which it
/// extends by what a state needs.
struct ConditionLeaf {
  /// Entities by their names, as in queries, or "$parameter".
  std::string entity;
  std::string path;  ///< As Data::at reads it; empty: any snapshot will do.
  /// The number must have reached this bound, or be below it if it crosses it falling.
  std::optional<double> bound;
  ltm::Crossing crossing = ltm::Crossing::kRising;
  std::optional<idf::Data> equals;  ///< A text may be "$parameter".
  std::string matches;              ///< A regular expression (RE2) that the whole text must match.
  std::vector<ltm::Telling> tells;
  /// Only a snapshot that comes from now on counts, at the moment at which it comes.
  bool is_new = false;
  std::optional<Duration> max_age;  ///< A snapshot that is older does not count.
  std::string binds;  ///< The parameter that becomes a link to the snapshot that met it.
};

/// A condition of a skill: a tree of all, any and not over leaves.
struct Condition {
  enum class Kind : uint8_t { kAll, kAny, kNot, kLeaf };

  static constexpr size_t kMaxLeaves = 64;

  Kind kind = Kind::kAll;
  std::vector<Condition> parts;  ///< One of kNot; none of kLeaf.
  ConditionLeaf leaf;
  /// It must have been so for this long.
  Duration holds_for{};

  /// True if nothing is required.
  [[nodiscard]] bool is_empty() const { return kind == Kind::kAll && parts.empty(); }
};

/// Reads a condition; a list means all of its elements.
/// Errors: kInvalidArgument naming file, line and key.
/// Source: docs/skills.md, "Conditions".
Result<Condition> read_condition(const ConfigValue& value);

/// "Objects/Instances/.*/cup: is_visible equals true, for 500ms", for people.
[[nodiscard]] std::string to_string(const Condition& condition);

/// The leaves of a tree, from left to right.
[[nodiscard]] std::vector<const ConditionLeaf*> leaves_of(const Condition& condition);

/// The parameters that it names with a dollar sign.
[[nodiscard]] std::set<std::string> parameters_in(const Condition& condition);

/// The same condition with the values of parameters in place of their names: the entity of a link,
/// or a text.
/// Errors: kInvalidArgument naming a parameter that is missing, or is no entity where one is
/// needed.
Result<Condition> with_parameters(const Condition& condition, const idf::Data& parameters);

}  // namespace engram::skills
