// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/facts.h"

#include <vector>

#include "datasets/kitchen/kitchen_types.h"
#include "datasets/kitchen/renderer.h"
#include "ltm/typed/image.h"

namespace engram::datasets::kitchen::facts {

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

idf::NdArray doubles(std::span<const double> values) {
  return idf::NdArray::take({static_cast<int64_t>(values.size())},
                            std::vector<double>(values.begin(), values.end()));
}

}  // namespace

idf::Data recording(uint64_t seed, double seconds, const DrawingSize& size, const Lighting& light) {
  ::kitchen::Recording recording;
  recording.seed = static_cast<int64_t>(seed);
  recording.seconds = seconds;
  recording.width = size.width;
  recording.height = size.height;
  recording.samples = size.samples;
  recording.lamp = static_cast<float>(light.lamp);
  recording.daylight = static_cast<float>(light.daylight);
  recording.warmth = static_cast<float>(light.warmth);
  if (!size.is_painted) recording.has_images = false;
  return recording.to_idf();
}

idf::Data calibration(Side side, const DrawingSize& size, const Pose& pose_head_camera) {
  const Pinhole pinhole = Pinhole::of(size);
  ::kitchen::CameraCalibration camera;
  camera.name = to_string(side);
  camera.width = size.width;
  camera.height = size.height;
  camera.fx = camera.fy = pinhole.focal;
  camera.cx = pinhole.centre_x;
  camera.cy = pinhole.centre_y;
  camera.pose_head_camera = recorded(pose_head_camera);
  return camera.to_idf();
}

idf::Data description(std::span<const double> lower, std::span<const double> upper,
                      const std::string& urdf) {
  ::kitchen::RobotDescription robot;
  robot.name = "humanoid on a platform";
  for (int i = kPlatformJoints; i < kRobotJoints; ++i)
    robot.joint_names.push_back(joint_names().at(static_cast<size_t>(i)));
  robot.lower = doubles(lower);
  robot.upper = doubles(upper);
  robot.urdf = urdf;
  return robot.to_idf();
}

idf::Data surface(Surface surface) {
  const SurfacePlace& place = place_of(surface);
  ::kitchen::Surface known;
  known.name = place.name;
  known.pose_world_surface = {place.top_m, Eigen::Quaterniond(Eigen::AngleAxisd(
                                               place.heading_rad, Eigen::Vector3d::UnitZ()))};
  known.depth = place.depth_m;
  known.width = place.width_m;
  return known.to_idf();
}

idf::Data object_class(const ThingClass& type) {
  ::kitchen::ObjectClass known;
  known.name = type.name;
  known.spoken_name = type.spoken_name;
  known.shape = type.shape == Shape::kBox ? "box" : "cylinder";
  known.size = doubles({type.size_m.data(), 3});
  known.mass = type.mass_kg;
  known.grasp_height = type.grasp_height_m;
  return known.to_idf();
}

idf::Data joints(const RobotVector& positions, const RobotVector& velocities) {
  ::kitchen::JointState joints;
  joints.positions = floats(positions, kPlatformJoints, kJoints);
  joints.velocities = floats(velocities, kPlatformJoints, kJoints);
  return joints.to_idf();
}

idf::Data platform(const RobotVector& positions, const RobotVector& velocities) {
  ::kitchen::PlatformState platform;
  platform.pose_world_platform = floats(positions, 0, kPlatformJoints);
  platform.velocity = floats(velocities, 0, kPlatformJoints);
  return platform.to_idf();
}

idf::Data view(const idf::NdArray& image, const Pose& pose_world_camera,
               const ltm::MemoryId& calibration, const Links& links) {
  ::kitchen::View view;
  view.image = typed::mat_of(image).value();
  view.pose_world_camera = recorded(pose_world_camera);
  view.calibration = calibration;
  view.joints = links.joints;
  view.platform = links.platform;
  return view.to_idf();
}

idf::Data object(const ltm::MemoryId& object_class, const Pose& pose, bool is_visible,
                 std::string_view held_by, const Links& links, std::string_view colour) {
  ::kitchen::ColouredInstance instance;
  instance.object_class = object_class;
  instance.pose_world_object = recorded(pose);
  instance.is_visible = is_visible;
  instance.held_by = held_by;
  instance.image = links.image;
  instance.joints = links.joints;
  instance.platform = links.platform;
  instance.colour = colour;
  return colour.empty() ? instance.ObjectInstance::to_idf() : instance.to_idf();
}

}  // namespace engram::datasets::kitchen::facts
