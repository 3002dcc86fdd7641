// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace engram::encoders {

/// How training went at one moment; means are smoothed.
struct CurvePoint {
  int32_t phase = 0;  ///< 0 autoencoder, 1 dynamics, 2 motion.
  int64_t step = 0;   ///< Of the phase.
  float seconds = 0;  ///< Of work since training began; 0 where the number of steps was fixed.
  float loss = 0;
  float psnr_db = 0;  ///< Mean over images; 0 where there are none.
  float bytes = 0;    ///< Of the latents of a value, as the prior tells; 0 where it does not.

  friend bool operator==(const CurvePoint&, const CurvePoint&) = default;
};

/// A training from its beginning on, in few points however long it takes: those of every step, then
/// of every second, fourth, ... one.
///
/// Threading: one thread.
class TrainingCurve {
 public:
  static constexpr size_t kMaxPoints = 64;

  TrainingCurve() = default;
  /// Goes on from the points of another one as that would have.
  explicit TrainingCurve(std::vector<CurvePoint> points);

  /// Points come in the order of phases and steps.
  void add(const CurvePoint& point);

  [[nodiscard]] const std::vector<CurvePoint>& points() const { return points_; }

 private:
  std::vector<CurvePoint> points_;
  int64_t stride_ = 1;  ///< Steps that are kept are multiples of it.
};

}  // namespace engram::encoders
