// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ltm/filter/entity_pattern.h"
#include "ltm/idf/type.h"
#include "ltm/memory/snapshot.h"

namespace engram::ltm {

/// The direction in which a value must cross a bound.
enum class Crossing : uint8_t { kRising, kFalling, kEither };

/// What a snapshot may tell by its members, whatever they are called (ltm/memory/told_events.h).
enum class Telling : uint8_t {
  kFailure,  ///< An action failed.
  kStop,     ///< An action was stopped.
  kSuccess,  ///< An action succeeded.
  kSpeech,   ///< Somebody said something.
  kLinks,    ///< It leads to other entities than the snapshot of its entity before.
};

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

  /// A snapshot that tells any of these is an event. Not beside `path`.
  std::vector<Telling> tells{};

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

  /// True if `snapshot` is an event. The rule must apply to its entity. `type` is that of its
  /// values, if it is known: integers tell outcomes by the names that it has for them. Complexity:
  /// O(size of the value at the path).
  bool is_event(const Snapshot& snapshot, const std::optional<idf::Type>& type);

 private:
  enum class Side : uint8_t { kUnknown, kBelow, kAbove };

  bool crosses(Side& side, double value) const;
  bool tells(const Snapshot& snapshot, const std::optional<idf::Type>& type);

  EventRule rule_;
  std::map<MemoryId, std::vector<Side>> sides_;  ///< Per entity, the side of each element.
  std::map<MemoryId, uint64_t> links_;           ///< Per entity, where its last snapshot led.
};

}  // namespace engram::ltm
