// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "ltm/memory/memory_id.h"
#include "ltm/store/finding.h"

namespace engram::ltm {

/// What can be noticed about recorded data. Each kind is one question that is asked of an entity.
enum class ReflectionKind : uint8_t {
  kGap,           ///< Snapshots are missing where the entity usually has them.
  kRate,          ///< Several snapshots in a row come faster or slower than usual.
  kOutOfBounds,   ///< A number outside the bounds of its type, or outside described limits.
  kNotFinite,     ///< NaN or infinity.
  kFrozen,        ///< Values stand still though the entity was moving.
  kDuplicate,     ///< The value of another snapshot again, with another time.
  kSpike,         ///< A single value far from its neighbours.
  kJump,          ///< A step that is larger than the entity moves.
  kDrift,         ///< Values leave what the rest of the data says, slowly.
  kClockDrift,    ///< What lies between a snapshot's time and its arrival grows or shrinks.
  kDeadLink,      ///< A link to a snapshot or an entity that the store does not have.
  kForeignLink,   ///< A link to a core segment of which the store has nothing.
  kLinkTime,      ///< A link leads to another time than such links usually do.
  kTimeShift,     ///< The motion of an entity is earlier or later than that of those it links to.
  kBrokenAction,  ///< An action without its end or without its begin.
  kUnreadable,    ///< A snapshot that does not decode.
};

/// All kinds, in the order above.
[[nodiscard]] const std::vector<ReflectionKind>& all_reflection_kinds();

/// The names that are printed and stored: "gap", "rate", "out-of-bounds", ...
[[nodiscard]] std::string_view to_string(ReflectionKind kind);
[[nodiscard]] std::string_view to_string(Severity severity);

/// One thing that was noticed.
struct ReflectionFinding {
  ReflectionKind kind = ReflectionKind::kGap;
  Severity severity = Severity::kFault;
  MemoryId entity;
  std::string member;  ///< Its path and the element, "positions[3]"; empty: the whole entity.
  Time first{};        ///< The span, both ends included. They are times of snapshots.
  Time last{};
  uint64_t count = 1;  ///< Number of snapshots or links that it stands for.
  std::string found;
  std::string expected;
};

/// What the numbers of a member are like.
struct MemberReflection {
  std::string path;
  std::string unit;
  bool is_motion = false;  ///< Whether speed and jerk mean something.
  /// Quantiles 0.05, 0.5 and 0.95 of each element.
  std::vector<double> low, middle, high;
  /// Quantile 0.99 over moments in which it moves; of the element with the largest. Unit: that of
  /// the member per s, and per s^3.
  double speed = 0;
  double jerk = 0;
};

/// What an entity is like in time.
struct EntityReflection {
  MemoryId id;
  uint64_t snapshots = 0;
  Time first{};
  Time last{};
  /// Whether its snapshots come at a steady rate. All else is zero or empty where they do not.
  bool is_periodic = false;
  double median_step_s = 0;
  uint64_t missing = 0;   ///< Snapshots that its gaps lack.
  double gap_s = 0;       ///< Duration of its gaps.
  double idle_share = 1;  ///< Share of time without motion. 0..1.
  double longest_idle_s = 0;
  bool has_motion = false;
  std::optional<double> latency_s;  ///< Median from its time to its arrival.
  std::vector<MemberReflection> members;
  std::set<ReflectionKind> looked_at;
};

/// Between two numbers: how often something succeeds.
struct SuccessRate {
  std::string by;     ///< "all", "object", "hand" or "place".
  std::string name;   ///< Of the object, hand or place; "-": none.
  uint64_t runs = 0;  ///< Those that ended.
  uint64_t successes = 0;
  uint64_t failures = 0;
  uint64_t stops = 0;
  double low = 0;  ///< Wilson's interval of 95 % of successes / runs.
  double high = 1;
  double mean_duration_s = 0;
};

struct SkillReflection {
  std::string skill;
  uint64_t unfinished = 0;
  std::vector<SuccessRate> rates;  ///< That of all runs first.
};

/// Steps that followed each other, from one that did not succeed to the end of the trouble.
struct FailureChain {
  std::vector<std::string> steps;  ///< "pick failure", "navigate success", "pick success".
  uint64_t count = 0;
};

/// How much earlier the motion of `entity` is than that of `other`, to which it links.
struct ShiftReflection {
  MemoryId entity;
  MemoryId other;
  double shift_s = 0;      ///< Positive: `entity` is late.
  double correlation = 0;  ///< At that shift.
};

/// What a store tells about itself.
struct Reflection {
  std::string store;
  uint64_t snapshots = 0;
  uint64_t looks = 0;  ///< Entities times the kinds that each was looked at for.
  std::vector<EntityReflection> entities;
  std::vector<ReflectionFinding> findings;  ///< Faults first, then by entity and time.
  uint64_t untold = 0;  ///< Findings beyond the max number for one entity and kind.
  std::vector<SkillReflection> skills;
  std::vector<FailureChain> chains;  ///< The commonest first.
  std::vector<ShiftReflection> shifts;

  [[nodiscard]] uint64_t count(Severity severity) const;
};

}  // namespace engram::ltm
