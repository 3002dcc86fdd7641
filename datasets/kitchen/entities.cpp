// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/entities.h"

#include "datasets/kitchen/kitchen.h"
#include "datasets/kitchen/kitchen_types.h"
#include "ltm/skills/skill_ids.h"

namespace engram::datasets {

namespace kitchen::entities {

namespace {

ltm::MemoryId id(const char* memory, const char* core, const char* provider,
                 std::string_view entity) {
  return ltm::MemoryId::from_names({memory, core, provider, std::string(entity)}).value();
}

}  // namespace

ltm::MemoryId recording() {
  return id("Simulation", "Recording", "kitchen", "options");
}
ltm::MemoryId calibration(std::string_view camera) {
  return id("Vision", "Calibration", "head", camera);
}
ltm::MemoryId stereo() {
  return id("Vision", "RGB", "head", "stereo");
}
ltm::MemoryId depth() {
  return id("Vision", "Depth", "head", "left");
}
ltm::MemoryId description() {
  return id("RobotState", "Description", "robot", "body");
}
ltm::MemoryId joints() {
  return id("RobotState", "Proprioception", "robot", "joints");
}
ltm::MemoryId platform() {
  return id("RobotState", "Localization", "robot", "platform");
}
ltm::MemoryId object_class(const ThingClass& type) {
  return id("Objects", "Classes", "kitchen", type.name);
}
ltm::MemoryId surface(Surface surface) {
  return id("Objects", "Surfaces", "kitchen", place_of(surface).name);
}
ltm::MemoryId object(const ThingClass& type) {
  return id("Objects", "Instances", "kitchen", std::string(type.name) + "_1");
}
ltm::MemoryId speech() {
  return id("Speech", "Commands", "human", "text");
}
ltm::MemoryId plan() {
  return id("Tasks", "Plans", "robot", "plan");
}
ltm::MemoryId executable(std::string_view skill) {
  return skills::executable_id({"robot", std::string(skill)});
}
ltm::MemoryId request(std::string_view skill) {
  return skills::request_id("planner", skill);
}
ltm::MemoryId action(std::string_view skill) {
  return skills::event_id({"robot", std::string(skill)});
}

}  // namespace kitchen::entities

std::vector<std::pair<ltm::MemoryId, idf::Type>> kitchen_types(bool has_images, bool has_colours) {
  namespace of = kitchen::entities;
  const auto core = [](const ltm::MemoryId& entity) { return entity.parent().parent(); };
  const kitchen::ThingClass& any = kitchen::all_thing_classes().front();
  std::vector<std::pair<ltm::MemoryId, idf::Type>> types{
      {core(of::recording()), ::kitchen::Recording::idf_type()},
      {core(of::description()), ::kitchen::RobotDescription::idf_type()},
      {core(of::joints()), ::kitchen::JointState::idf_type()},
      {core(of::platform()), ::kitchen::PlatformState::idf_type()},
      {core(of::object_class(any)), ::kitchen::ObjectClass::idf_type()},
      {core(of::surface(kitchen::Surface::kTable)), ::kitchen::Surface::idf_type()},
      {core(of::object(any)), has_colours ? ::kitchen::ColouredInstance::idf_type()
                                          : ::kitchen::ObjectInstance::idf_type()},
      {core(of::speech()), ::kitchen::Speech::idf_type()},
      {core(of::plan()), ::kitchen::Plan::idf_type()}};
  if (has_images) {
    types.emplace_back(core(of::calibration("left")), ::kitchen::CameraCalibration::idf_type());
    types.emplace_back(core(of::stereo()), ::kitchen::View::idf_type());
    types.emplace_back(core(of::depth()), ::kitchen::DepthView::idf_type());
  }
  for (auto& one : skills::skill_types()) types.push_back(std::move(one));
  // The robot of a recording tells more of an execution than every skill does.
  types.emplace_back(of::action("pick").parent(), ::kitchen::Action::idf_type());
  return types;
}

}  // namespace engram::datasets
