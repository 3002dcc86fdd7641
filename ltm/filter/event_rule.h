// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ltm/filter/entity_pattern.h"
#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// Which way a value has to cross a bound.
enum class Crossing : uint8_t { kRising, kFalling, kEither };

/// Says which snapshots are events that make the time around them worth keeping.
struct EventRule {
  /// Whose snapshots are looked at. Nothing: those of the entity that is filtered.
  std::optional<EntityPattern> entity;

  /// Where the number is, as Data::at reads it; every element of an array counts by itself.
  /// Empty: every snapshot of `entity` is an event.
  std::string path;

  /// Unit: that of the number. A value that equals it is above.
  double bound = 0;

  /// A value that is beyond the bound when it is first seen has crossed it, but for kEither.
  Crossing crossing = Crossing::kRising;

  [[nodiscard]] Status validate() const;
};

/// Finds the events of one rule. NaN is on neither side and changes nothing.
///
/// Threading: one thread.
class EventDetector {
 public:
  explicit EventDetector(EventRule rule) : rule_(std::move(rule)) {}

  [[nodiscard]] const EventRule& rule() const { return rule_; }

  /// True where the rule is for this entity, seen from a filter of `own`.
  [[nodiscard]] bool is_for(const MemoryId& entity, const MemoryId& own) const;

  /// True where `snapshot`, for which the rule is, is an event.
  /// Complexity: O(size of what is at the path).
  bool is_event(const Snapshot& snapshot);

 private:
  enum class Side : uint8_t { kUnknown, kBelow, kAbove };

  bool crosses(Side& side, double value) const;

  EventRule rule_;
  std::map<MemoryId, std::vector<Side>> sides_;  ///< Per entity, of each element.
};

}  // namespace engram::ltm
