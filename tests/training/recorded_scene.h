// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "ltm/recording/recorder.h"
#include "tests/training/moving_scene.h"
#include "training/night/consolidate.h"

namespace engram::testing {

/// The entity of most stores.
inline constexpr const char* kSquare = "Test/Scene/sim/square";

inline ltm::MemoryId id(const std::string& text) {
  return *ltm::MemoryId::parse(text);
}

/// Latents alone, of a model that was trained for some steps.
inline training::ConsolidateOptions quick_consolidation() {
  training::ConsolidateOptions options;
  options.train = quick_options(20);
  options.representation.kind = training::Representation::kLatents;
  return options;
}

/// Consolidates a store whose first entity must not be skipped, and reports on it.
inline training::EntityReport night(const std::filesystem::path& store,
                                    const training::ConsolidateOptions& options) {
  auto report = training::consolidate(store, options, {}, {});
  EXPECT_TRUE(report.ok()) << report.status().to_string();
  if (!report.ok()) return {};
  EXPECT_EQ(report->entities[0].skipped_reason, "");
  return std::move(report->entities[0]);
}

/// Appends `count` snapshots of the scene, from `first` on, to an entity of a store.
inline void record(const std::filesystem::path& store, const std::string& entity, int first,
                   int count, bool has_numbers = true) {
  auto recorder = ltm::Recorder::open(store, {});
  ASSERT_TRUE(recorder.ok()) << recorder.status().to_string();
  const auto source = scene_source(first + count);
  for (int i = first; i < first + count; ++i) {
    const Time time = source.times[static_cast<size_t>(i)];
    const ltm::Snapshot snapshot{id(entity), time, {{scene_at(i, true, has_numbers), {}}}};
    ASSERT_TRUE(recorder->commit({{snapshot}}).ok());
  }
  ASSERT_TRUE(recorder->close().ok());
}

}  // namespace engram::testing
