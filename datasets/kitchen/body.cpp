// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/body.h"

#include <utility>

#include "datasets/kitchen/movable_places.h"
#include "datasets/kitchen/poke.h"
#include "datasets/kitchen/renderer.h"
#include "datasets/kitchen/stance.h"

namespace engram::datasets::kitchen {

namespace {

constexpr double kBodyLookAhead_s = 0.5;  ///< How long the neck takes to follow its target.
constexpr double kSample_s = 1.0 / RobotBus::kRate_hz;
constexpr int kBodySteps = static_cast<int>(kSample_s / World::kStep_s + 0.5);
/// The platform stops so far from what is in its way, beyond what it needs to stop.
constexpr double kClear_m = 0.08;
constexpr double kStopTime_s = 0.2;

}  // namespace

Body::Body(World world, const DrawingSize& size)
    : world_(std::make_unique<World>(std::move(world))),
      size_(size),
      kinematics_(*world_),
      trajectory_(RobotVector::Zero()) {
  RobotVector pose = starting_pose();
  gaze_.point = place_of(Surface::kTable).top_m;
  const auto [yaw, pitch] = kinematics_.look_at(pose, gaze_.point);
  pose[joint_index("neck_yaw")] = yaw;
  pose[joint_index("neck_pitch")] = pitch;
  trajectory_ = Trajectory(pose);
  world_->place_robot(pose);
  for (int i = 0; i < kSettlingSteps; ++i) world_->step(trajectory_.at(0));
  world_->refresh();
}

Result<Body> Body::create(const KitchenOptions& options, const DrawingSize& size) {
  Layout layout = make_layout(options.seed);
  layout.has_movables = true;
  ENGRAM_ASSIGN_OR_RETURN(World world, World::create(layout, size));
  return Body(std::move(world), size);
}

double Body::now_s() const {
  return static_cast<double>(sample_) * kSample_s;
}

void Body::follow() {
  Eigen::Vector3d at = gaze_.point;
  if (gaze_.thing) at = world_->thing_pose(*gaze_.thing).translation();
  if (gaze_.movable) at = world_->movable_pose(*gaze_.movable).translation();
  const auto [yaw, pitch] = kinematics_.look_at(world_->positions(), at);
  trajectory_.move(joint_index("neck_yaw"), yaw, now_s(), kBodyLookAhead_s);
  trajectory_.move(joint_index("neck_pitch"), pitch, now_s(), kBodyLookAhead_s);
}

std::string_view Body::in_the_way(const Eigen::Vector2d& velocity) const {
  const Eigen::Vector2d at = world_->positions().head<2>();
  const Eigen::Vector2d then = at + kStopTime_s * velocity;
  for (size_t i = 0; i < movable_classes().size(); ++i) {
    const ThingClass& type = movable_classes()[i];
    const Pose pose = world_->movable_pose(i);
    const double distance = distance_m(type, pose, then);
    // A platform that is too close may still drive away.
    if (distance < kPlatformRadius_m + kClear_m && distance < distance_m(type, pose, at))
      return type.name;
  }
  return {};
}

void Body::keep_clear() {
  blocked_by_ = in_the_way(trajectory_.at(now_s()).velocity.head<2>());
  if (!blocked_by_.empty()) brake();
}

void Body::brake() {
  drive_.end();
  for (int joint = 0; joint < kPlatformJoints; ++joint) trajectory_.stop(joint, now_s());
}

void Body::advance() {
  if (sample_ % RobotBus::kImageEvery == 0) follow();
  // A platform that has begun to stop is left to it; braking anew would take longer.
  if (blocked_by_.empty()) keep_clear();
  for (int step = 0; step < kBodySteps; ++step) {
    const double at_s = now_s() + step * World::kStep_s;
    drive_.step(at_s, World::kStep_s, trajectory_);
    world_->step(trajectory_.at(at_s));
  }
  world_->refresh();
  ++sample_;
}

BodyState Body::sense() {
  BodyState state;
  state.sample = sample_;
  state.positions = world_->positions();
  state.velocities = world_->velocities();
  state.pose_world_left_hand = world_->hand_pose(Side::kLeft);
  state.pose_world_right_hand = world_->hand_pose(Side::kRight);
  state.has_news = std::exchange(has_news_, false);
  state.blocked_by = blocked_by_;
  const Pinhole pinhole = Pinhole::of(size_);
  const Pose pose_camera_world = world_->camera_pose(Side::kLeft).inverse();
  const auto add = [&](const ThingClass& type, const Pose& pose, const auto& is_in_sight) {
    const bool is_shown = pinhole.shows(pose_camera_world * pose.translation(), size_);
    state.objects.push_back(
        {.name = std::string(type.name), .pose = pose, .is_visible = is_shown && is_in_sight()});
  };
  for (size_t i = 0; i < world_->layout().things.size(); ++i) {
    add(type_of(i), world_->thing_pose(i), [&] { return world_->is_in_sight(i); });
    for (const Side side : {Side::kLeft, Side::kRight})
      if (world_->held(side) == i) state.objects.back().held_by = to_string(side);
  }
  for (size_t i = 0; i < movable_classes().size(); ++i) {
    const Pose pose = world_->movable_pose(i);
    add(movable_classes()[i], pose,
        [&] { return !is_away(pose) && world_->is_movable_in_sight(i); });
  }
  return state;
}

const ThingClass& Body::type_of(size_t object) const {
  const std::vector<Thing>& things = world_->layout().things;
  return object < things.size() ? *things[object].type : movable_classes()[object - things.size()];
}

Pose Body::pose_of_object(size_t object) const {
  const size_t things = world_->layout().things.size();
  return object < things ? world_->thing_pose(object) : world_->movable_pose(object - things);
}

std::string Body::names_there() const {
  std::string names;
  const size_t count = world_->layout().things.size() + movable_classes().size();
  for (size_t i = 0; i < count; ++i)
    names += (names.empty() ? "" : ", ") + std::string(type_of(i).spoken_name);
  return names;
}

Result<size_t> Body::object_named(std::string_view name) const {
  const size_t count = world_->layout().things.size() + movable_classes().size();
  for (size_t i = 0; i < count; ++i)
    if (is_called(type_of(i), name)) return i;
  return not_found("the kitchen has no '{}'; it has {}", name, names_there());
}

Result<size_t> Body::thing_named(std::string_view name) const {
  ENGRAM_ASSIGN_OR_RETURN(const size_t object, object_named(name));
  if (object >= world_->layout().things.size())
    return invalid_argument("the {} is nothing that a hand holds", name);
  return object;
}

}  // namespace engram::datasets::kitchen
