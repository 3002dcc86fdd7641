// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/trajectory.h"

namespace engram::datasets::kitchen {

namespace {

constexpr double kStop_s = 0.4;
constexpr double kRun_s = 0.02;

}  // namespace

Trajectory::Trajectory(const RobotVector& at) {
  for (int i = 0; i < kRobotJoints; ++i) {
    Segment& segment = segments_[static_cast<size_t>(i)];
    segment.goal = segment.c[0] = at[i];
  }
}

Trajectory::Moment Trajectory::at(const Segment& segment, double time_s) {
  const double t = time_s - segment.start_s;
  if (t >= segment.duration_s) return {segment.goal, 0, 0};
  const auto& c = segment.c;
  return {c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5])))),
          c[1] + t * (2 * c[2] + t * (3 * c[3] + t * (4 * c[4] + t * 5 * c[5]))),
          2 * c[2] + t * (6 * c[3] + t * (12 * c[4] + t * 20 * c[5]))};
}

void Trajectory::move(int joint, double to, double now_s, double duration_s) {
  Segment& segment = segments_.at(static_cast<size_t>(joint));
  const auto [p, v, a] = at(segment, now_s);
  const double t = duration_s;
  const double h = to - p;
  segment = {.start_s = now_s,
             .duration_s = t,
             .c = {p, v, a / 2, (20 * h - 12 * v * t - 3 * a * t * t) / (2 * t * t * t),
                   (-30 * h + 16 * v * t + 3 * a * t * t) / (2 * t * t * t * t),
                   (12 * h - 6 * v * t - a * t * t) / (2 * t * t * t * t * t)},
             .goal = to};
}

void Trajectory::run(int joint, double from, double velocity, double now_s) {
  segments_.at(static_cast<size_t>(joint)) = {.start_s = now_s,
                                              .duration_s = kRun_s,
                                              .c = {from, velocity, 0, 0, 0, 0},
                                              .goal = from + velocity * kRun_s};
}

void Trajectory::stop(double now_s) {
  for (int i = 0; i < kRobotJoints; ++i) stop(i, now_s);
}

void Trajectory::stop(int joint, double now_s) {
  const auto [p, v, a] = at(segments_.at(static_cast<size_t>(joint)), now_s);
  move(joint, p + 0.5 * kStop_s * v, now_s, kStop_s);
}

Motion Trajectory::at(double time_s) const {
  Motion motion;
  for (int i = 0; i < kRobotJoints; ++i) {
    const auto [p, v, a] = at(segments_[static_cast<size_t>(i)], time_s);
    motion.position[i] = p;
    motion.velocity[i] = v;
    motion.acceleration[i] = a;
  }
  return motion;
}

RobotVector Trajectory::goal() const {
  RobotVector goal;
  for (int i = 0; i < kRobotJoints; ++i) goal[i] = segments_[static_cast<size_t>(i)].goal;
  return goal;
}

}  // namespace engram::datasets::kitchen
