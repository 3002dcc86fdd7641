// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "ltm/core/progress.h"
#include "ltm/core/status.h"
#include "ltm/core/time.h"
#include "ltm/idf/ndarray.h"

namespace engram::datasets {

struct SceneOptions {
  /// Size of the images: even numbers, 32 to 1024. Unit: pixels.
  int width = 160;
  int height = 120;
  double seconds = 60;  ///< At most 3600.
  int rate_hz = 15;     ///< 1 to 240.
  /// The seed of the background, of the order in which objects are moved, and of the pace.
  uint64_t seed = 1;
  /// Standard deviation of the sensor's noise. Unit: grey levels, 0 to 32.
  double noise_sigma = 1.5;
  /// Quality of the video that write_scene makes; see VideoWriter::Options.
  int crf = 14;

  [[nodiscard]] Status validate() const;
};

/// The readings of the arm's encoders.
struct ArmState {
  double shoulder_rad = 0;  ///< Angle above the horizontal.
  double elbow_rad = 0;     ///< Angle from the line of the upper arm; negative bends down.
  double gripper = 0;       ///< From 0, closed, to 1, open.
  double shoulder_velocity_rad_s = 0;
  double elbow_velocity_rad_s = 0;
};

struct SceneFrame {
  Duration time{};  ///< Time since the start, rounded to the nearest nanosecond.
  /// Shape: uint8 [height, width, 3], RGB.
  idf::NdArray image;
  ArmState arm;
};

/// A drawn scene for demos and tests. In front of a still, textured room, an arm with two joints
/// picks a bottle, a box or a ball from a table and places it elsewhere, with pauses, repeatedly.
///
/// Equal options give equal frames.
/// Threading: const-parallel.
class Scene {
 public:
  /// Errors: kInvalidArgument if `options` do not validate.
  static Result<Scene> create(const SceneOptions& options);

  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  [[nodiscard]] uint64_t frames() const;

  /// Renders frame `index`, which must be less than frames() (checked). Frames may be rendered in
  /// any order. Errors: kResourceExhausted if there is not enough memory.
  Result<SceneFrame> render(uint64_t index) const;

 private:
  struct State;
  explicit Scene(std::unique_ptr<const State> state);

  std::unique_ptr<const State> state_;
};

/// Renders a scene into a video and a table of the arm's state with a row per frame: `timestamp`
/// in seconds with nine digits, joint.shoulder, joint.elbow, joint.gripper, velocity.shoulder,
/// velocity.elbow. Equal options give equal bytes.
/// Errors: those of Scene and VideoWriter.
Status write_scene(const SceneOptions& options, const std::filesystem::path& video,
                   const std::filesystem::path& table, const ProgressSink& progress);

}  // namespace engram::datasets
