// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/reporter.h"

#include <utility>

#include "datasets/kitchen/entities.h"
#include "datasets/kitchen/robot_urdf.h"
#include "ltm/typed/image.h"

namespace engram::datasets::kitchen {

namespace {

typed::Pose<double> recorded(const Pose& pose) {
  Eigen::Quaterniond turn(pose.linear());
  // q and -q are the same rotation; fixing the sign makes equal poses equal values.
  if (turn.w() < 0) turn.coeffs() *= -1;
  return {pose.translation(), turn.normalized()};
}

idf::NdArray floats(const RobotVector& values, int from, int count) {
  std::vector<float> result;
  for (int i = from; i < from + count; ++i) result.push_back(static_cast<float>(values[i]));
  return idf::NdArray::take({count}, std::move(result));
}

cv::Mat picture(const idf::NdArray& array) {
  return typed::mat_of(array).value();
}

}  // namespace

Reporter::Reporter(const KitchenOptions& options, const DrawingSize& size, const World& world,
                   Renderer& renderer, CommitSink sink)
    : options_(options), size_(size), world_(world), renderer_(renderer), sink_(std::move(sink)) {}

Time Reporter::time_of(uint64_t sample) const {
  return options_.start + std::chrono::milliseconds(1000 / kRate_hz) * static_cast<int64_t>(sample);
}

void Reporter::add(ltm::MemoryId entity, uint64_t sample, std::vector<idf::Data> values,
                   std::string_view provider) {
  const Time time = time_of(sample);
  ltm::EntityUpdate update{.entity = std::move(entity), .time = time};
  for (idf::Data& value : values)
    update.instances.push_back(
        {std::move(value),
         {.created = time, .sent = time, .arrived = time, .provider = std::string(provider)}});
  raw_bytes_ += update.raw_bytes();
  pending_.updates.push_back(std::move(update));
}

void Reporter::report_prior(const Layout& layout) {
  ::kitchen::Recording recording;
  recording.seed = static_cast<int64_t>(options_.seed);
  recording.seconds = options_.seconds;
  recording.width = size_.width;
  recording.height = size_.height;
  recording.samples = size_.samples;
  recording.lamp = static_cast<float>(layout.light.lamp);
  recording.daylight = static_cast<float>(layout.light.daylight);
  recording.warmth = static_cast<float>(layout.light.warmth);
  add(entities::recording(), 0, {recording.to_idf()}, "simulation");

  const Pinhole pinhole = Pinhole::of(size_);
  for (const Side side : {Side::kLeft, Side::kRight}) {
    ::kitchen::CameraCalibration camera;
    camera.name = to_string(side);
    camera.width = size_.width;
    camera.height = size_.height;
    camera.fx = camera.fy = pinhole.focal;
    camera.cx = pinhole.centre_x;
    camera.cy = pinhole.centre_y;
    camera.pose_head_camera =
        recorded(world_.body_pose("head").inverse() * world_.camera_pose(side));
    add(entities::calibration(to_string(side)), 0, {camera.to_idf()}, "simulation");
  }

  ::kitchen::RobotDescription robot;
  robot.name = "humanoid on a platform";
  std::vector<double> lower;
  std::vector<double> upper;
  for (int i = kPlatformJoints; i < kRobotJoints; ++i) {
    robot.joint_names.push_back(joint_names().at(static_cast<size_t>(i)));
    lower.push_back(world_.range(i).first);
    upper.push_back(world_.range(i).second);
  }
  robot.lower = idf::NdArray::take({kJoints}, std::move(lower));
  robot.upper = idf::NdArray::take({kJoints}, std::move(upper));
  robot.urdf = robot_urdf(world_);
  add(entities::description(), 0, {robot.to_idf()}, "simulation");

  for (const Surface surface : {Surface::kCounter, Surface::kTable}) {
    const SurfacePlace& place = place_of(surface);
    ::kitchen::Surface known;
    known.name = place.name;
    known.pose_world_surface = {place.top_m, Eigen::Quaterniond(Eigen::AngleAxisd(
                                                 place.heading_rad, Eigen::Vector3d::UnitZ()))};
    known.depth = place.depth_m;
    known.width = place.width_m;
    add(entities::surface(surface), 0, {known.to_idf()}, "prior");
  }
  for (const ThingClass& type : all_thing_classes()) {
    ::kitchen::ObjectClass known;
    known.name = type.name;
    known.spoken_name = type.spoken_name;
    known.shape = type.shape == Shape::kBox ? "box" : "cylinder";
    known.size = idf::NdArray::take(
        {3}, std::vector<double>{type.size_m.x(), type.size_m.y(), type.size_m.z()});
    known.mass = type.mass_kg;
    known.grasp_height = type.grasp_height_m;
    add(entities::object_class(type), 0, {known.to_idf()}, "prior");
  }
}

ltm::MemoryId Reporter::report_speech(uint64_t sample, const std::string& speaker,
                                      const std::string& text) {
  ::kitchen::Speech speech;
  speech.speaker = speaker;
  speech.text = text;
  add(entities::speech(), sample, {speech.to_idf()}, "speech");
  return entities::speech().at(time_of(sample)).instance(0);
}

ltm::MemoryId Reporter::report_plan(uint64_t sample, const ::kitchen::Plan& plan) {
  add(entities::plan(), sample, {plan.to_idf()}, "planner");
  return entities::plan().at(time_of(sample)).instance(0);
}

ltm::MemoryId Reporter::report_action(uint64_t sample, const ::kitchen::Action& action) {
  add(entities::action(action.skill), sample, {action.to_idf()}, "skills");
  // Every begin and end of an action has object poses, although it need not fall on their 5 Hz.
  objects_are_due_ = true;
  return entities::action(action.skill).at(time_of(sample)).instance(0);
}

void Reporter::add_robot(uint64_t sample) {
  const RobotVector positions = world_.positions();
  const RobotVector velocities = world_.velocities();
  ::kitchen::JointState joints;
  joints.positions = floats(positions, kPlatformJoints, kJoints);
  joints.velocities = floats(velocities, kPlatformJoints, kJoints);
  add(entities::joints(), sample, {joints.to_idf()}, "robot");
  ::kitchen::PlatformState platform;
  platform.pose_world_platform = floats(positions, 0, kPlatformJoints);
  platform.velocity = floats(velocities, 0, kPlatformJoints);
  add(entities::platform(), sample, {platform.to_idf()}, "robot");
}

void Reporter::add_images(uint64_t sample) {
  const Time time = time_of(sample);
  StereoPicture stereo = renderer_.draw(world_, options_.records_depth);
  std::vector<idf::Data> views;
  for (const Side side : {Side::kLeft, Side::kRight}) {
    ::kitchen::View view;
    view.image = picture(side == Side::kLeft ? stereo.left : stereo.right);
    view.pose_world_camera = recorded(world_.camera_pose(side));
    view.calibration = entities::calibration(to_string(side)).at(time_of(0)).instance(0);
    view.joints = entities::joints().at(time).instance(0);
    view.platform = entities::platform().at(time).instance(0);
    views.push_back(view.to_idf());
  }
  add(entities::stereo(), sample, std::move(views), "camera");
  if (!options_.records_depth) return;
  ::kitchen::DepthView depth;
  depth.depth =
      picture(idf::NdArray::take({size_.height, size_.width, 1}, std::move(stereo.depth_mm)));
  depth.view = entities::stereo().at(time).instance(0);
  add(entities::depth(), sample, {depth.to_idf()}, "camera");
}

void Reporter::add_objects(uint64_t sample) {
  const Time time = time_of(sample);
  const Pinhole pinhole = Pinhole::of(size_);
  const Pose pose_camera_world = world_.camera_pose(Side::kLeft).inverse();
  const std::vector<Thing>& things = world_.layout().things;
  for (size_t i = 0; i < things.size(); ++i) {
    const Pose pose = world_.thing_pose(i);
    const Eigen::Vector3d seen = pose_camera_world * pose.translation();
    bool is_in_image = false;
    if (seen.z() > 0) {
      const Eigen::Vector2d at = pinhole.project(seen);
      is_in_image =
          at.x() >= 0 && at.y() >= 0 && at.x() <= size_.width - 1 && at.y() <= size_.height - 1;
    }
    ::kitchen::ObjectInstance instance;
    instance.object_class = entities::object_class(*things[i].type).at(time_of(0)).instance(0);
    instance.pose_world_object = recorded(pose);
    instance.is_visible = is_in_image && world_.is_in_sight(i);
    for (const Side side : {Side::kLeft, Side::kRight})
      if (world_.held(side) == i) instance.held_by = to_string(side);
    instance.image = entities::stereo().at(time).instance(0);
    instance.joints = entities::joints().at(time).instance(0);
    instance.platform = entities::platform().at(time).instance(0);
    add(entities::object(*things[i].type), sample, {instance.to_idf()}, "localization");
  }
}

Status Reporter::record(uint64_t sample) {
  add_robot(sample);
  if (sample % kImageEvery == 0) add_images(sample);
  if (sample % kObjectsEvery == 0 || objects_are_due_) add_objects(sample);
  objects_are_due_ = false;
  // Snapshots link to others of the same time, so all of them go into one commit.
  const ltm::Commit commit = std::exchange(pending_, {});
  return sink_(commit);
}

}  // namespace engram::datasets::kitchen
