// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "ltm/memory/commit.h"

namespace engram::experiments {

/// Simulates the small objects that a tracker sees: at each step a snapshot of every entity, with
/// 33 bytes of plain numbers. Every snapshot can be computed from its entity and step.
struct ScaleWorld {
  static constexpr int kMaxEntities = 64;

  int entities = 20;
  uint64_t steps = 0;

  static constexpr int64_t kStepNs = 10000000;  ///< 100 Hz.
  /// One of kOneLateOf commits comes late, by kLateBy steps.
  static constexpr uint64_t kOneLateOf = 1000;
  static constexpr uint64_t kLateBy = 50;
  /// Plain bytes of one snapshot: three doubles, one int64, one bool.
  static constexpr uint64_t kPlainBytes = 33;

  [[nodiscard]] static Time time_of(uint64_t step);
  [[nodiscard]] ltm::MemoryId entity(int number) const;
  [[nodiscard]] static idf::Data value(int entity, uint64_t step);
  /// Returns the commit of all entities at one step.
  [[nodiscard]] ltm::Commit commit(uint64_t step) const;
};

}  // namespace engram::experiments
