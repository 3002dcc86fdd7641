// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/idf/type.h"
#include "ltm/memory/commit.h"

namespace engram::datasets {

struct KitchenOptions {
  /// Chooses objects, where they stand, the light, what is asked for and what goes wrong.
  uint64_t seed = 1;
  double seconds = 60;  ///< 1 to 3600.
  /// Of each image of the stereo pair. Even numbers of 32 to 1024. Unit: pixels.
  int width = 640;
  int height = 480;
  /// Smooth edges (4 samples per pixel) and fine shadows; costs about two thirds of the time.
  bool is_fine = true;
  /// Records depth of the left camera too, which makes 12 MB more a second at 640 x 480.
  bool records_depth = false;
  /// Of the first snapshot. Must be after 1970 and before 2200.
  Time start = time_from_ns(1'767'254'400'000'000'000);  // 2026-01-01 08:00

  /// 128 x 128 without smooth edges and fine shadows: for tests and demos.
  static KitchenOptions fast();

  [[nodiscard]] Status validate() const;
};

/// What happened in a recording, beside what it holds.
struct KitchenSummary {
  uint64_t images = 0;     ///< Stereo pairs.
  uint64_t raw_bytes = 0;  ///< Plain bytes of all snapshots.
  int succeeded = 0;       ///< Actions by outcome.
  int failed = 0;
  int stopped = 0;
};

/// Takes what is recorded: everything of one time in one commit, in the order of times.
using CommitSink = std::function<Status(const ltm::Commit&)>;

/// The core segments of a kitchen recording with the types of their values.
[[nodiscard]] std::vector<std::pair<ltm::MemoryId, idf::Type>> kitchen_types();

/// Simulates a humanoid with 43 joints on a platform that is asked to bring objects from a counter
/// to a table and back, and records what it perceives and does: stereo images at 20 Hz, joints and
/// platform at 100 Hz, poses of objects at 5 Hz, commands, plans and actions with their outcomes,
/// all linked to each other.
///
/// Equal options give equal commits on one machine.
/// Errors: kInvalidArgument if `options` do not validate; kUnavailable where nothing can be drawn
/// (Mesa's EGL is missing); those of `sink`.
/// Threading: one thread at a time in a process; it has OpenGL draw in threads of its own.
/// Source: docs/kitchen.md.
Result<KitchenSummary> simulate_kitchen(const KitchenOptions& options, const CommitSink& sink,
                                        const ProgressSink& progress);

}  // namespace engram::datasets
