// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the movements in the drawn scene (datasets/drawn_scene.h).

#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "datasets/drawn_scene.h"

namespace engram::datasets::scene {

/// Unit: the height of the stage, whose width is 4/3. Frame: origin at its top left, x right, y
/// down.
struct Point {
  double x = 0;
  double y = 0;
};

enum Kind { kBottle, kBox, kBall, kKinds };

inline constexpr double kStageWidth = 4.0 / 3.0;
inline constexpr double kTableY = 0.80;  ///< Height at which things stand.
inline constexpr Point kShoulder{0.22, 0.56};
inline constexpr double kUpperArm = 0.50;
inline constexpr double kForearm = 0.50;
inline constexpr double kFinger = 0.09;  ///< Length from the wrist down to the gripped point.

/// Height above its foot at which a thing is gripped.
inline constexpr std::array<double, kKinds> kGripHeight{0.165, 0.085, 0.075};

/// The state of everything that moves, at one time.
struct Moment {
  ArmState arm;
  Point elbow;
  Point wrist;
  std::array<Point, kKinds> feet;  ///< The middle of each thing's underside.
  int held = -1;                   ///< The Kind that the gripper holds, or -1.
};

/// Uniform random numbers that do not depend on the standard library.
class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}

  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  size_t below(size_t count) { return engine_() % count; }

 private:
  std::mt19937_64 engine_;
};

/// Minimum-jerk movements from one key pose to the next. The plan covers at least `seconds`.
///
/// Threading: immutable.
class Plan {
 public:
  Plan(uint64_t seed, double seconds);

  [[nodiscard]] Moment at(double seconds) const;

 private:
  /// A pose of the arm, and the state that holds from it until the next key.
  struct Key {
    double seconds = 0;
    double shoulder = 0;
    double elbow = 0;
    double gripper = 0;
    int held = -1;
    std::array<double, kKinds> foot_x{};
  };

  void move(double duration, Point wrist);
  void grip(double duration, double opening);
  void wait(double duration);
  void carry(Random& random);

  std::vector<Key> keys_;
  std::array<size_t, kKinds> slots_{};  ///< The slot of each thing while planning.
};

}  // namespace engram::datasets::scene
