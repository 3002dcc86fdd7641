// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/store/store_writer.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/store/example_snapshots.h"

namespace engram::ltm {

inline MemoryId cup_entity() {
  return *MemoryId::from_names({"Objects", "Instances", "kitchen", "cup"});
}
inline MemoryId skill_entity() {
  return *MemoryId::from_names({"Skills", "Actions", "robot", "pick"});
}
inline MemoryId words_entity() {
  return *MemoryId::from_names({"Speech", "Commands", "human", "text"});
}

inline constexpr int64_t kMovesFrom = 100;
inline constexpr int64_t kMovesUntil = 120;

/// Where a cup is at step `i`: it rests, is carried from step 100 to step 120, and rests again.
inline double cup_x(int64_t i) {
  return 0.1 *
         static_cast<double>(std::clamp<int64_t>(i - kMovesFrom, 0, kMovesUntil - kMovesFrom));
}

/// Steps [first, end) of a day, five a second: a cup that is carried once, a pick at step 40 that
/// fails at step 60, and one from 100 to 120 that succeeds; before each somebody says something.
inline void record_day(const std::filesystem::path& store, int64_t first, int64_t end) {
  const auto writer = StoreWriter::open(store, {.durability = Durability::kNone});
  ASSERT_OK(writer);
  const auto append = [&](const MemoryId& entity, int64_t i, idf::Dict value) {
    Snapshot snapshot{entity, example_time(i), {{std::move(value), example_metadata(i)}}};
    ASSERT_OK((*writer)->append({pack_snapshot(snapshot)}, nullptr));
  };
  for (int64_t i = first; i < end; ++i) {
    const bool is_held = i >= kMovesFrom && i < kMovesUntil;
    const std::string hand =
        "RobotState/Proprioception/arm/joints/" + to_string(example_time(i)) + "/0";
    append(cup_entity(), i,
           {{"position", idf::NdArray::take({2}, std::vector<double>{cup_x(i), 1})},
            {"held_by", is_held ? hand : std::string()}});
    const auto act = [&](const std::string& outcome) {
      append(skill_entity(), i, {{"skill", "pick"}, {"outcome", outcome}});
    };
    if (i == 40 || i == kMovesFrom) act("running");
    if (i == 60) act("failure");
    if (i == kMovesUntil) act("success");
    if (i == 35 || i == 95)
      append(words_entity(), i,
             {{"speaker", "human"}, {"text", "Bring the cup, step " + std::to_string(i)}});
  }
  ASSERT_OK((*writer)->seal());
}

}  // namespace engram::ltm
