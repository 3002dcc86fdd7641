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

/// The direction in which a value must cross a bound.
enum class Crossing : uint8_t { kRising, kFalling, kEither };

/// Defines which snapshots are events, so that the time around them is worth keeping.
struct EventRule {
  /// The entities whose snapshots may be events. Empty: the entity that is filtered.
  std::optional<EntityPattern> entity;

  /// Path of the number, as Data::at reads it. Each element of an array crosses the bound by
  /// itself. Empty: every snapshot of `entity` is an event.
  std::string path;

  /// A value that equals the bound is above it. Unit: that of the number.
  double bound = 0;

  /// A value that is beyond the bound when it is first seen has crossed it, except with kEither.
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

  /// True if the rule in a filter of the entity `own` applies to `entity`.
  [[nodiscard]] bool is_for(const MemoryId& entity, const MemoryId& own) const;

  /// True if `snapshot` is an event. The rule must apply to its entity.
  /// Complexity: O(size of the value at the path).
  bool is_event(const Snapshot& snapshot);

 private:
  enum class Side : uint8_t { kUnknown, kBelow, kAbove };

  bool crosses(Side& side, double value) const;

  EventRule rule_;
  std::map<MemoryId, std::vector<Side>> sides_;  ///< Per entity, the side of each element.
};

}  // namespace engram::ltm
