// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ltm/filter/entity_pattern.h"
#include "ltm/memory/snapshot.h"
#include "server/skills/skill_condition.h"

namespace re2 {
class RE2;
}

namespace engram::skills {

/// A condition that is not met, and what was found in its place.
struct Unmet {
  std::string condition;  ///< For people, see to_string(Condition).
  std::string found;
  std::optional<ltm::MemoryId> where{};  ///< The instance in which it was found.

  [[nodiscard]] std::string to_string() const { return condition + " (found " + found + ")"; }
};

/// Whether a condition is met, from the snapshots that come.
///
/// It keeps one short note per entity that its patterns match, and no values.
/// Time: `now` never goes back.
/// Threading: one thread.
/// Source: docs/skills.md, "Conditions".
class ConditionState {
 public:
  /// `condition` has no parameters left (with_parameters()).
  /// Errors: kInvalidArgument if a pattern or an expression of it cannot be read.
  static Result<ConditionState> create(const Condition& condition);

  /// Takes what is the case already: it counts for states, and not as new.
  void seed(const ltm::Snapshot& snapshot);

  /// Takes a snapshot that came. Returns true if any leaf looks at its entity. Call is_met() before
  /// the next one: what is new is so for that moment alone.
  bool offer(const ltm::Snapshot& snapshot);

  /// Whether it is met, and no longer by what was new. Changes what `for` counts from.
  [[nodiscard]] bool is_met(Time now);

  /// When is_met() may change without a snapshot; nothing if it cannot.
  [[nodiscard]] std::optional<Time> next_change(Time now) const;

  /// Why it is not met. Empty if it is.
  [[nodiscard]] std::vector<Unmet> unmet(Time now) const;

  /// The instances that met it, as far as they were found in the last is_met() that was true.
  [[nodiscard]] const std::vector<ltm::MemoryId>& causes() const { return causes_; }
  /// The parameters that it gives: names, and links to what met it.
  [[nodiscard]] const std::map<std::string, ltm::MemoryId>& bound() const { return bound_; }

  /// The patterns of entities that it looks at.
  [[nodiscard]] std::vector<std::string> patterns() const;

 private:
  /// What is known of one entity.
  struct Known {
    Time time{};
    Time since{};  ///< Of the first snapshot since which it has been so.
    bool is_met = false;
    std::string found;
    ltm::MemoryId instance;
  };
  struct Node {
    Condition::Kind kind = Condition::Kind::kAll;
    Duration holds_for{};
    std::string text;
    std::vector<size_t> parts;
    std::optional<Time> since;  ///< Since when it has been met without regard to `holds_for`.
    // Of leaves:
    ConditionLeaf leaf;
    ltm::EntityPattern pattern;
    std::shared_ptr<const re2::RE2> matches;
    std::unique_ptr<ltm::EventDetector> detector;  ///< Of what is new.
    std::map<ltm::MemoryId, Known> known;
    std::optional<ltm::MemoryId> pulse;  ///< The instance that is new at this moment.
  };
  /// More entities than this are not looked at by one leaf.
  static constexpr size_t kMaxEntities = 10'000;

  Result<size_t> add(const Condition& condition);
  /// Whether any leaf looks at its entity.
  bool take(const ltm::Snapshot& snapshot, bool is_new);
  void take(Node& node, const ltm::Snapshot& snapshot, const std::optional<idf::Type>& type,
            bool is_new);
  [[nodiscard]] static bool is_asked(const Node& node, const ltm::Instance& instance,
                                     std::string& found);
  [[nodiscard]] static const Known* met_by(const Node& node, Time now);
  bool judge(size_t index, Time now, bool is_wanted);
  [[nodiscard]] bool was_met(size_t index, Time now) const;
  void explain(size_t index, Time now, bool is_wanted, std::vector<Unmet>& unmet) const;

  std::vector<Node> nodes_;  ///< Parts before what they are parts of; the root is the last.
  std::vector<ltm::MemoryId> causes_;
  std::map<std::string, ltm::MemoryId> bound_;
};

}  // namespace engram::skills
