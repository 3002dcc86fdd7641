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
  /// The seed of the objects, their places, the light, the requests and the faults.
  uint64_t seed = 1;
  double seconds = 60;  ///< 1 to 3600.
  /// Size of each image of the stereo pair: even numbers, 32 to 1024. Unit: pixels.
  int width = 640;
  int height = 480;
  /// Smooth edges (4 samples per pixel) and fine shadows. They cost about two thirds of the time.
  bool is_fine = true;
  /// False: nothing is drawn, so EGL is not needed, and a second of the recording takes a tenth of
  /// a second. What the robot does is the same. The size then only says what would be in sight.
  bool has_images = true;
  /// Also records the depth of the left camera, which adds 12 MB per second at 640 x 480. Needs
  /// images.
  bool records_depth = false;
  /// Gives each thing a colour by the seed, which its snapshots tell in a member `colour`. Nothing
  /// else of the recording changes, but for the pixels.
  bool has_colours = false;
  /// The time of the first snapshot. Must be after 1970 and before 2200.
  Time start = time_from_ns(1'767'254'400'000'000'000);  // 2026-01-01 08:00

  /// Options for tests and demos: 128 x 128 without smooth edges and fine shadows.
  static KitchenOptions fast();

  [[nodiscard]] Status validate() const;
};

/// Counts what happened in a recording.
struct KitchenSummary {
  uint64_t images = 0;     ///< Number of stereo pairs that were recorded.
  uint64_t raw_bytes = 0;  ///< Uncompressed bytes of all snapshots.
  int succeeded = 0;       ///< Actions by their outcome.
  int failed = 0;
  int stopped = 0;
};

/// Receives the recorded data: one commit for everything of one time, in the order of times.
using CommitSink = std::function<Status(const ltm::Commit&)>;

/// Returns the core segments of a kitchen recording with the types of their values; without those
/// of `Vision` where there are no images. Objects have the member `colour` where things have one.
[[nodiscard]] std::vector<std::pair<ltm::MemoryId, idf::Type>> kitchen_types(
    bool has_images = true, bool has_colours = false);

/// Simulates a humanoid with 43 joints on a platform. It is asked to bring objects from a counter
/// to a table and back, and what it perceives and does is recorded: stereo images at 20 Hz, joints
/// and platform at 100 Hz, poses of objects at 5 Hz, commands, plans and actions with their
/// outcomes, all linked to each other.
///
/// Equal options give equal commits on one machine.
/// Errors: kInvalidArgument if `options` do not validate; kUnavailable if nothing can be drawn
/// (Mesa's EGL is missing); those of `sink`.
/// Threading: one thread at a time in a process; OpenGL draws in threads of its own.
/// Source: docs/kitchen.md.
Result<KitchenSummary> simulate_kitchen(const KitchenOptions& options, const CommitSink& sink,
                                        const ProgressSink& progress);

}  // namespace engram::datasets
