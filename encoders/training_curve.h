// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace engram::encoders {

/// The state of training at one step. Means are smoothed.
struct CurvePoint {
  int32_t phase = 0;  ///< 0 autoencoder, 1 dynamics, 2 motion.
  int64_t step = 0;   ///< Of the phase.
  float seconds = 0;  ///< Time of work since training began; 0 if the number of steps was fixed.
  float loss = 0;
  float psnr_db = 0;  ///< Mean over images; 0 without images.
  float bytes = 0;    ///< Of the latents of a value, estimated by the prior; 0 if unknown.

  friend bool operator==(const CurvePoint&, const CurvePoint&) = default;
};

/// The course of a training in at most kMaxPoints points. It starts with a point for every step and
/// thins out to every second, fourth, ... step.
///
/// Threading: one thread.
class TrainingCurve {
 public:
  static constexpr size_t kMaxPoints = 64;

  TrainingCurve() = default;
  /// Continues from the points of another curve.
  explicit TrainingCurve(std::vector<CurvePoint> points);

  /// Points come in the order of phases and steps.
  void add(const CurvePoint& point);

  [[nodiscard]] const std::vector<CurvePoint>& points() const { return points_; }

 private:
  std::vector<CurvePoint> points_;
  int64_t stride_ = 1;  ///< Kept steps are multiples of it.
};

}  // namespace engram::encoders
