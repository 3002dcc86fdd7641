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
  /// Size of the images. Even numbers of 32 to 1024. Unit: pixels.
  int width = 160;
  int height = 120;
  double seconds = 60;  ///< At most an hour.
  int rate_hz = 15;     ///< 1 to 240.
  /// Chooses the background, which object goes where, and the pace.
  uint64_t seed = 1;
  /// Standard deviation of the sensor's noise. Unit: grey levels, 0 to 32.
  double noise_sigma = 1.5;
  /// Quality of the video that write_scene makes; see VideoWriter::Options.
  int crf = 14;

  [[nodiscard]] Status validate() const;
};

/// What the encoders of the arm say.
struct ArmState {
  double shoulder_rad = 0;  ///< From the horizontal, upwards.
  double elbow_rad = 0;     ///< From the line of the upper arm; negative bends down.
  double gripper = 0;       ///< 0 closed, 1 open.
  double shoulder_velocity_rad_s = 0;
  double elbow_velocity_rad_s = 0;
};

struct SceneFrame {
  Duration time{};  ///< From the start, rounded to the nearest nanosecond.
  /// Shape: uint8 [height, width, 3], RGB.
  idf::NdArray image;
  ArmState arm;
};

/// A drawn scene for demos and tests: before a still, textured room, an arm with two joints picks
/// a bottle, a box or a ball from a table and places it elsewhere, with pauses, again and again.
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

  /// Any frame, in any order. Needs index < frames() (checked).
  /// Errors: kResourceExhausted where memory is used up.
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
