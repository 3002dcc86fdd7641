// SPDX-License-Identifier: Apache-2.0
#include "datasets/scene_plan.h"

#include <algorithm>
#include <cmath>

namespace engram::datasets::scene {

namespace {

constexpr std::array<double, 4> kSlotX{0.50, 0.72, 0.94, 1.14};
constexpr double kLiftY = 0.30;
constexpr Point kHome{0.62, 0.38};

struct Joints {
  double shoulder;
  double elbow;
};

/// Returns the joint angles that bring the wrist to a point, with the elbow up.
Joints joints_of(Point wrist) {
  const double x = wrist.x - kShoulder.x;
  const double up = kShoulder.y - wrist.y;
  const double bend =
      (x * x + up * up - kUpperArm * kUpperArm - kForearm * kForearm) / (2 * kUpperArm * kForearm);
  const double elbow = -std::acos(std::clamp(bend, -1.0, 1.0));
  const double lead =
      std::atan2(kForearm * std::sin(elbow), kUpperArm + kForearm * std::cos(elbow));
  return {std::atan2(up, x) - lead, elbow};
}

Point along(Point from, double length, double angle) {
  return {from.x + length * std::cos(angle), from.y - length * std::sin(angle)};
}

/// Returns the position of the wrist when thing `kind` stands at `x` between the fingers.
Point grasp(size_t kind, double x) {
  return {x, kTableY - kGripHeight[kind] - kFinger};
}

double eased(double u) {
  return u * u * u * (10 + u * (6 * u - 15));
}
double eased_slope(double u) {
  return 30 * u * u * (1 - u) * (1 - u);
}

}  // namespace

Plan::Plan(uint64_t seed, double seconds) {
  Random random(seed);
  for (size_t kind = 0; kind < kKinds; ++kind) {
    do {
      slots_[kind] = random.below(kSlotX.size());
    } while (std::find(slots_.begin(), slots_.begin() + static_cast<std::ptrdiff_t>(kind),
                       slots_[kind]) != slots_.begin() + static_cast<std::ptrdiff_t>(kind));
  }
  const Joints home = joints_of(kHome);
  Key first{.shoulder = home.shoulder, .elbow = home.elbow, .gripper = 1};
  for (size_t kind = 0; kind < kKinds; ++kind) first.foot_x[kind] = kSlotX[slots_[kind]];
  keys_.push_back(first);
  while (keys_.back().seconds <= seconds) {
    wait(random.between(0.3, 1.2));
    carry(random);
    if (random.below(2) == 0) move(random.between(0.7, 1.1), kHome);
  }
}

void Plan::move(double duration, Point wrist) {
  const Joints joints = joints_of(wrist);
  Key key = keys_.back();
  key.seconds += duration;
  key.shoulder = joints.shoulder;
  key.elbow = joints.elbow;
  keys_.push_back(key);
}

void Plan::grip(double duration, double opening) {
  keys_.push_back(keys_.back());
  keys_.back().seconds += duration;
  keys_.back().gripper = opening;
}

void Plan::wait(double duration) {
  keys_.push_back(keys_.back());
  keys_.back().seconds += duration;
}

/// Plans the transport of one thing to the free slot.
void Plan::carry(Random& random) {
  const size_t kind = random.below(kKinds);
  const double from = kSlotX[slots_[kind]];
  size_t target = 0;
  while (std::find(slots_.begin(), slots_.end(), target) != slots_.end()) ++target;
  const double to = kSlotX[target];
  const double pace = random.between(0.85, 1.25);

  // The wrist goes over the things, at the height of kLiftY, and down only at the slots.
  move(0.9 * pace, {from, kLiftY});
  move(0.6 * pace, grasp(kind, from));
  grip(0.4, 0.15);
  keys_.back().held = static_cast<int>(kind);
  move(0.6 * pace, {from, kLiftY});
  move((0.6 + 0.7 * std::abs(to - from)) * pace, {to, kLiftY});
  move(0.7 * pace, grasp(kind, to));
  keys_.back().held = -1;
  keys_.back().foot_x[kind] = to;
  slots_[kind] = target;
  grip(0.35, 1);
  move(0.6 * pace, {to, kLiftY});
}

/// A held thing hangs below the wrist, so the image always agrees with the encoders.
Moment Plan::at(double seconds) const {
  const auto next =
      std::upper_bound(keys_.begin() + 1, keys_.end() - 1, seconds,
                       [](double time, const Key& key) { return time < key.seconds; });
  const Key& a = *(next - 1);
  const Key& b = *next;
  const double duration = b.seconds - a.seconds;
  const double u = std::clamp((seconds - a.seconds) / duration, 0.0, 1.0);
  const double s = eased(u);
  const double rate = eased_slope(u) / duration;

  Moment moment;
  moment.arm = {.shoulder_rad = std::lerp(a.shoulder, b.shoulder, s),
                .elbow_rad = std::lerp(a.elbow, b.elbow, s),
                .gripper = std::lerp(a.gripper, b.gripper, s),
                .shoulder_velocity_rad_s = (b.shoulder - a.shoulder) * rate,
                .elbow_velocity_rad_s = (b.elbow - a.elbow) * rate};
  moment.elbow = along(kShoulder, kUpperArm, moment.arm.shoulder_rad);
  moment.wrist = along(moment.elbow, kForearm, moment.arm.shoulder_rad + moment.arm.elbow_rad);
  moment.held = a.held;
  for (size_t kind = 0; kind < kKinds; ++kind) {
    const bool is_held = a.held == static_cast<int>(kind);
    moment.feet[kind] = is_held
                            ? Point{moment.wrist.x, moment.wrist.y + kFinger + kGripHeight[kind]}
                            : Point{a.foot_x[kind], kTableY};
  }
  return moment;
}

}  // namespace engram::datasets::scene
