// SPDX-License-Identifier: Apache-2.0
#include "tests/server/navigation/simulated_floor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/server/navigation/floor_example.h"

namespace engram::navigation::testing {

namespace {

constexpr double kHalfRoomM = 4.6;

Obstacle round_body(const std::string& name, const Eigen::Vector2d& at, double diameter_m) {
  Obstacle body;
  body.name = name;
  body.shape = Obstacle::Shape::kCylinder;
  body.pose_world_obstacle = {at.x(), at.y(), 0};
  body.size_m = {diameter_m, diameter_m};
  return body;
}

Obstacle box_body(const std::string& name, const PlanarPose& pose, double x_m, double y_m) {
  Obstacle body;
  body.name = name;
  body.pose_world_obstacle = pose;
  body.size_m = {x_m, y_m};
  return body;
}

double towards(double now, double wanted, double max_change) {
  return now + std::clamp(wanted - now, -max_change, max_change);
}

}  // namespace

SimulatedFloor::SimulatedFloor(Memory& memory, const Options& options)
    : memory_(memory), options_(options), random_(options.seed), now_(kBegin + options.latency) {
  furniture_ = {
      box_body("table", {1.5, 1, 0.3}, 0.9, 1.6), box_body("counter", {4.2, -1, 0}, 0.6, 4),
      box_body("shelf", {-2, 4.3, 1.57}, 0.5, 2.2), box_body("sofa", {-3.5, 0.8, 3.14}, 0.9, 2)};
  for (int i = 1; i <= options.chairs; ++i) {
    const PlanarPose at = free_place(0.4);
    chairs_.push_back({box_body(fmt::format("chair_{}", i), at, 0.45, 0.45), 0.9});
    move_to(chairs_.back(), at);
  }
  for (int i = 1; i <= options.persons; ++i) {
    const PlanarPose at = free_place(0.5);
    persons_.push_back({round_body(fmt::format("person_{}", i), at.position(), 0.5), 1.7});
    persons_.back().goal = random_point();
    move_to(persons_.back(), persons_.back().body.pose_world_obstacle);
  }
}

Eigen::Vector2d SimulatedFloor::random_point() {
  std::uniform_real_distribution<double> place(-kHalfRoomM, kHalfRoomM);
  const double x = place(random_);
  return {x, place(random_)};
}

double SimulatedFloor::clearance_m(const Eigen::Vector2d& point, const std::string& but) const {
  double min_m = 1e9;
  for (const Obstacle& body : furniture_) min_m = std::min(min_m, body.distance_m(point));
  for (const auto* movers : {&chairs_, &persons_})
    for (const Mover& mover : *movers)
      if (mover.body.name != but) min_m = std::min(min_m, mover.body.distance_m(point));
  return min_m;
}

PlanarPose SimulatedFloor::free_place(double clear_m) {
  std::uniform_real_distribution<double> heading(-std::numbers::pi, std::numbers::pi);
  while (true) {
    const Eigen::Vector2d at = random_point();
    const PlanarPose pose{at.x(), at.y(), heading(random_)};
    if (clearance_m(at, {}) > clear_m + 0.1 && (at - robot_.position()).norm() > 1) return pose;
  }
}

Status SimulatedFloor::commit_first() {
  ltm::Commit commit{
      {class_of("chair", "box", 0.45, 0.45, 0.9), class_of("person", "cylinder", 0.5, 0.5, 1.7)}};
  for (const Obstacle& body : furniture_)
    commit.updates.push_back(
        surface_at(body.name, body.pose_world_obstacle, 0.75, body.size_m.x(), body.size_m.y()));
  ENGRAM_RETURN_IF_ERROR(memory_.commit(commit, CommitDurability::kMemory));
  // What is there from the beginning was seen.
  for (auto* movers : {&chairs_, &persons_})
    for (Mover& mover : *movers) mover.unseen.front().first = now_ - options_.latency;
  return commit_seen();
}

void SimulatedFloor::move_to(Mover& mover, const PlanarPose& pose) const {
  mover.body.pose_world_obstacle = pose;
  mover.unseen.emplace_back(now_, pose);
}

Status SimulatedFloor::commit_seen() {
  const Time seen = now_ - options_.latency;
  ltm::Commit commit;
  for (auto* movers : {&chairs_, &persons_})
    for (Mover& mover : *movers) {
      std::optional<PlanarPose> pose;
      for (; !mover.unseen.empty() && mover.unseen.front().first <= seen; mover.unseen.pop_front())
        pose = mover.unseen.front().second;
      if (!pose) continue;
      const bool is_person = mover.body.shape == Obstacle::Shape::kCylinder;
      commit.updates.push_back(thing_at(mover.body.name, is_person ? "person" : "chair", *pose,
                                        mover.height_m / 2, seen));
    }
  if (commit.updates.empty()) return {};
  ENGRAM_RETURN_IF_ERROR(memory_.commit(commit, CommitDurability::kMemory));
  if (provider_ == nullptr) return {};
  for (const ltm::Snapshot& update : commit.updates)
    if (!provider_->wait_for(update.id(), std::chrono::seconds(20)))
      return unavailable("no map of '{}'", update.id().to_string());
  if (!maps_->wait_for(*provider_->latest().id.time(), std::chrono::seconds(20)))
    return unavailable("nobody is told of the map");
  return {};
}

Result<BaseState> SimulatedFloor::state() {
  return BaseState{now_, robot_, twist_};
}

Status SimulatedFloor::move(const Twist& twist) {
  unheard_.emplace_back(now_ + options_.latency, twist);
  return {};
}

Status SimulatedFloor::stop() {
  return move({});
}

Status SimulatedFloor::wait(Duration time) {
  constexpr Duration kStep = std::chrono::milliseconds(10);
  for (Duration left = time; left > Duration::zero(); left -= kStep) {
    for (; !unheard_.empty() && unheard_.front().first <= now_; unheard_.pop_front())
      commanded_ = unheard_.front().second;
    now_ += kStep;
    step(to_seconds(kStep));
  }
  ENGRAM_RETURN_IF_ERROR(commit_seen());
  if (on_step) on_step();
  return {};
}

void SimulatedFloor::step(double seconds) {
  step_robot(seconds);
  for (size_t i = 0; i < persons_.size(); ++i)
    step_person(persons_[i], static_cast<int>(i), seconds);
  for (Mover& chair : chairs_) step_chair(chair, seconds);
  bool touches = false;
  const auto look_at = [&](const Obstacle& body) {
    const double distance = body.distance_m(robot_.position()) - options_.robot_radius_m;
    min_distance_m_ = std::min(min_distance_m_, distance);
    if (distance >= 0) return;
    touches = true;
    collided_with_ = body.name;
  };
  for (const Obstacle& body : furniture_) look_at(body);
  for (const auto* movers : {&chairs_, &persons_})
    for (const Mover& mover : *movers) look_at(mover.body);
  // A touch that lasts is one collision.
  if (touches && !touches_) ++collisions_;
  touches_ = touches;
}

void SimulatedFloor::step_robot(double seconds) {
  twist_.forward_m_s =
      towards(twist_.forward_m_s, commanded_.forward_m_s, options_.acceleration_m_s2 * seconds);
  twist_.turn_rad_s = towards(twist_.turn_rad_s, commanded_.turn_rad_s,
                              options_.turn_acceleration_rad_s2 * seconds);
  robot_ = robot_.times({twist_.forward_m_s * seconds, 0, twist_.turn_rad_s * seconds});
}

bool SimulatedFloor::try_to_go(Mover& mover, const Eigen::Vector2d& way, double seconds,
                               double keeps_m) {
  const Eigen::Vector2d before = mover.body.pose_world_obstacle.position();
  const Eigen::Vector2d at = before + way * seconds;
  const double radius = mover.body.outer_radius_m();
  const double to_robot = (at - robot_.position()).norm() - radius - options_.robot_radius_m;
  const bool comes_nearer = (at - robot_.position()).norm() < (before - robot_.position()).norm();
  if (comes_nearer && to_robot < keeps_m) return false;
  const double clear = clearance_m(at, mover.body.name);
  if (clear < radius && clear < clearance_m(before, mover.body.name)) return false;
  if (at.cwiseAbs().maxCoeff() > kHalfRoomM + 0.3) return false;
  move_to(mover, {at.x(), at.y(), mover.body.pose_world_obstacle.heading_rad});
  return true;
}

void SimulatedFloor::step_person(Mover& person, int number, double seconds) {
  if (surrounds_) {
    // Each at an own side, as near as persons come.
    const double angle = 2 * std::numbers::pi * number / static_cast<double>(persons_.size());
    person.goal = robot_.position() + 0.68 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    person.speed_m_s = 1;
  } else if (person.pause_s > 0) {
    person.pause_s -= seconds;
    return;
  }
  const Eigen::Vector2d way = person.goal - person.body.pose_world_obstacle.position();
  const auto choose = [&] {
    std::uniform_real_distribution<double> share(0, 1);
    // Half of all ways lead to near the robot: people come and look.
    person.goal = share(random_) < 0.5 ? robot_.position() + Eigen::Vector2d(share(random_) - 0.5,
                                                                             share(random_) - 0.5)
                                       : random_point();
    person.speed_m_s = 0.4 + 0.6 * share(random_);
    person.pause_s = share(random_) < 0.4 ? 4 * share(random_) : 0;
  };
  if (way.norm() < 0.05) {
    if (!surrounds_) choose();
    return;
  }
  const double speed = person.speed_m_s == 0 ? 0.8 : person.speed_m_s;
  if (!try_to_go(person, way.normalized() * std::min(speed, way.norm() / seconds), seconds, 0.1) &&
      !surrounds_)
    choose();
}

void SimulatedFloor::step_chair(Mover& chair, double seconds) {
  constexpr double kPushesPerSecond = 0.05;
  std::uniform_real_distribution<double> share(0, 1);
  if (chair.pause_s > 0) {
    chair.pause_s -= seconds;
    if (!try_to_go(chair, 0.4 * chair.goal, seconds, 0.05)) chair.pause_s = 0;
    return;
  }
  if (share(random_) > kPushesPerSecond * seconds) return;
  const double angle = 2 * std::numbers::pi * share(random_);
  chair.goal = {std::cos(angle), std::sin(angle)};
  chair.pause_s = 0.5 + share(random_);
}

void SimulatedFloor::surround(bool is_on) {
  surrounds_ = is_on;
  if (!is_on)
    for (Mover& person : persons_) {
      person.goal = random_point();
      person.pause_s = 0;
    }
}

std::optional<Obstacle> SimulatedFloor::body(const std::string& name) const {
  for (const Obstacle& body : furniture_)
    if (body.name == name) return body;
  for (const auto* movers : {&chairs_, &persons_})
    for (const Mover& mover : *movers)
      if (mover.body.name == name) return mover.body;
  return {};
}

Status SimulatedFloor::put(const std::string& name, const PlanarPose& pose) {
  for (auto* movers : {&chairs_, &persons_})
    for (Mover& mover : *movers)
      if (mover.body.name == name) {
        move_to(mover, pose);
        mover.goal = pose.position();
        mover.pause_s = mover.body.shape == Obstacle::Shape::kCylinder ? 1e6 : 0;
        return {};
      }
  return not_found("no '{}' on the floor", name);
}

}  // namespace engram::navigation::testing
