// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/reporter.h"

#include <utility>

#include "datasets/kitchen/entities.h"
#include "datasets/kitchen/recorded_skills.h"
#include "datasets/kitchen/robot_urdf.h"
#include "datasets/kitchen/thing_colours.h"
#include "ltm/typed/image.h"

namespace engram::datasets::kitchen {

namespace {

cv::Mat picture(const idf::NdArray& array) {
  return typed::mat_of(array).value();
}

}  // namespace

Reporter::Reporter(const KitchenOptions& options, const DrawingSize& size, const World& world,
                   Renderer* renderer, CommitSink sink)
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
  add(entities::recording(), 0,
      {facts::recording(options_.seed, options_.seconds, size_, layout.light)}, "simulation");
  if (has_images())
    for (const Side side : {Side::kLeft, Side::kRight})
      add(entities::calibration(to_string(side)), 0,
          {facts::calibration(side, size_,
                              world_.body_pose("head").inverse() * world_.camera_pose(side))},
          "simulation");
  std::vector<double> lower;
  std::vector<double> upper;
  for (int i = kPlatformJoints; i < kRobotJoints; ++i) {
    lower.push_back(world_.range(i).first);
    upper.push_back(world_.range(i).second);
  }
  add(entities::description(), 0, {facts::description(lower, upper, robot_urdf(world_))},
      "simulation");
  for (const Surface surface : {Surface::kCounter, Surface::kTable})
    add(entities::surface(surface), 0, {facts::surface(surface)}, "prior");
  for (const ThingClass& type : all_thing_classes())
    add(entities::object_class(type), 0, {facts::object_class(type)}, "prior");
  for (const auto& [skill, executable] : recorded_skills())
    add(entities::executable(skill), 0, {executable.to_idf()}, "skills");
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

ltm::MemoryId Reporter::report_request(uint64_t sample, const std::string& skill,
                                       const ::skill::ExecutionRequest& request) {
  add(entities::request(skill), sample, {request.to_idf()}, "planner");
  return entities::request(skill).at(time_of(sample)).instance(0);
}

ltm::MemoryId Reporter::report_action(uint64_t sample, const std::string& skill,
                                      const ::kitchen::Action& action) {
  add(entities::action(skill), sample, {action.to_idf()}, "skills");
  // Every begin and end of an action has object poses, although it need not fall on their 5 Hz.
  objects_are_due_ = true;
  return entities::action(skill).at(time_of(sample)).instance(0);
}

void Reporter::add_robot(uint64_t sample) {
  const RobotVector positions = world_.positions();
  const RobotVector velocities = world_.velocities();
  add(entities::joints(), sample, {facts::joints(positions, velocities)}, "robot");
  add(entities::platform(), sample, {facts::platform(positions, velocities)}, "robot");
}

facts::Links Reporter::links_at(Time time) const {
  facts::Links links{.joints = entities::joints().at(time).instance(0),
                     .platform = entities::platform().at(time).instance(0)};
  if (has_images()) links.image = entities::stereo().at(time).instance(0);
  return links;
}

void Reporter::add_images(uint64_t sample) {
  const Time time = time_of(sample);
  StereoPicture stereo = renderer_->draw(world_, options_.records_depth);
  std::vector<idf::Data> views;
  for (const Side side : {Side::kLeft, Side::kRight})
    views.push_back(facts::view(
        side == Side::kLeft ? stereo.left : stereo.right, world_.camera_pose(side),
        entities::calibration(to_string(side)).at(time_of(0)).instance(0), links_at(time)));
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
    std::string_view held_by;
    for (const Side side : {Side::kLeft, Side::kRight})
      if (world_.held(side) == i) held_by = to_string(side);
    add(entities::object(*things[i].type), sample,
        {facts::object(
            entities::object_class(*things[i].type).at(time_of(0)).instance(0), pose,
            pinhole.shows(pose_camera_world * pose.translation(), size_) && world_.is_in_sight(i),
            held_by, links_at(time),
            things[i].colour == nullptr ? std::string_view() : things[i].colour->name)},
        "localization");
  }
}

Status Reporter::record(uint64_t sample) {
  add_robot(sample);
  if (has_images() && sample % kImageEvery == 0) add_images(sample);
  if (sample % kObjectsEvery == 0 || objects_are_due_) add_objects(sample);
  objects_are_due_ = false;
  // Snapshots link to others of the same time, so all of them go into one commit.
  const ltm::Commit commit = std::exchange(pending_, {});
  return sink_(commit);
}

}  // namespace engram::datasets::kitchen
