// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the questions that are asked of an entity, one file each.

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ltm/reflection/finding_list.h"
#include "ltm/reflection/reflection.h"
#include "ltm/reflection/series_block.h"

namespace engram::ltm {

/// A span without snapshots of an entity, before it is known whether others have some.
struct PossibleGap {
  MemoryId entity;
  int64_t first_ns = 0;
  int64_t last_ns = 0;
  uint64_t missing = 0;
  double usual_s = 0;
};

/// Max number of possible gaps of all entities.
inline constexpr size_t kMaxPossibleGaps = 100'000;

/// Rates of an entity and its gaps. Sets what `entity` says of time.
void look_at_rates(const std::vector<int64_t>& times, EntityReflection& entity,
                   FindingList& findings, std::vector<PossibleGap>& gaps);

/// NaN, infinities and numbers outside the bounds of their type.
void look_at_bounds(const SeriesBlock& block, EntityReflection& entity, FindingList& findings);

/// Limits that a description gives for each element of `member`s of that many elements.
struct DescribedLimits {
  MemoryId description;
  std::vector<double> lower, upper;
};
/// Reads them of a block whose values have the members `lower` and `upper`.
[[nodiscard]] std::vector<DescribedLimits> find_limits(const SeriesBlock& block);
/// Numbers outside of described limits; only members called position or positions are looked at.
void look_at_limits(const SeriesBlock& block, const std::vector<DescribedLimits>& limits,
                    EntityReflection& entity, FindingList& findings);

/// Values that stand still or come again.
void look_at_frozen(const SeriesBlock& block, EntityReflection& entity, FindingList& findings);

/// How fast the elements of a member move, over all entities of a provider segment.
using SpeedPool = std::map<std::pair<MemoryId, std::string>, double>;

/// A step or a spike that is large for its entity; the pool decides about it.
struct PossibleJump {
  ReflectionFinding finding;
  std::string member;  ///< Of the pool.
  double speed = 0;
  double fast = 0;          ///< The largest usual speed of its element.
  bool needs_pool = false;  ///< Its element moves too seldom to say what is usual.
  bool is_large = false;    ///< The step is a large part of the values.
};

/// A member of a block and the one that is its change over time: positions and velocities.
struct ChangePair {
  size_t value = 0;  ///< Indices of columns.
  size_t change = 0;
};
/// Learned from the numbers, because names differ from robot to robot.
[[nodiscard]] std::vector<ChangePair> find_change_pairs(const SeriesBlock& block);

/// How fast the elements of an entity are that move the fastest, at each time.
struct EntityMotion {
  struct Element {
    std::string path;
    size_t index = 0;
    std::vector<float> speeds;  ///< One for each time; the first of a block is zero.
  };
  static constexpr size_t kMaxMotionElements = 24;
  /// Hours at 100 Hz; it bounds memory.
  static constexpr size_t kMaxMotionRows = size_t{1} << 20;

  std::vector<int64_t> times;
  std::vector<Element> elements;
};
/// Speeds, jerk, idle time; fills `pool`, `jumps` and `motion`. Members that are the change of
/// another one may jump, when something is touched.
void look_at_motion(const SeriesBlock& block, const std::vector<ChangePair>& pairs,
                    EntityReflection& entity, SpeedPool& pool, std::vector<PossibleJump>& jumps,
                    EntityMotion& motion);
/// Share of the largest usual speed from which on something moves.
inline constexpr double kMovingShare = 0.02;
/// What is faster than anything of its provider segment.
void judge_jumps(const SpeedPool& pool, std::vector<PossibleJump>& jumps, FindingList& findings);

/// Members that leave the integral of their change, slow creeping, and clocks that drift.
void look_at_drift(const SeriesBlock& block, const std::vector<ChangePair>& pairs,
                   EntityReflection& entity, FindingList& findings);

/// Links that lead nowhere, or to another time than usual.
void look_at_links(const SeriesBlock& block, EntityReflection& entity, FindingList& findings);

/// How the motion of entities that link to each other lies in time.
void look_at_shifts(const std::map<MemoryId, EntityMotion>& motions,
                    const std::set<std::pair<MemoryId, MemoryId>>& links,
                    const std::map<MemoryId, EntityReflection*>& entities,
                    std::vector<ShiftReflection>& shifts, FindingList& findings);

}  // namespace engram::ltm
