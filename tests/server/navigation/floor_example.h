// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/memory/commit.h"
#include "server/navigation/planar_pose.h"

namespace engram::navigation::testing {

inline const Time kBegin = time_from_ns(1'700'000'000'000'000'000);

inline ltm::MemoryId thing_id(const std::string& name) {
  return ltm::MemoryId::from_names({"Objects", "Instances", "kitchen", name}).value();
}
inline ltm::MemoryId class_id(const std::string& name) {
  return ltm::MemoryId::from_names({"Objects", "Classes", "kitchen", name}).value();
}
inline ltm::MemoryId surface_id(const std::string& name) {
  return ltm::MemoryId::from_names({"Objects", "Surfaces", "kitchen", name}).value();
}

inline idf::Data pose_data(const PlanarPose& pose, double z_m) {
  return idf::Dict{
      {"position", idf::NdArray::take<double>({3}, {pose.x_m, pose.y_m, z_m})},
      {"orientation", idf::NdArray::take<double>({4}, {std::cos(pose.heading_rad / 2), 0, 0,
                                                       std::sin(pose.heading_rad / 2)})}};
}

/// The class of things of a size, as the kitchen commits it.
inline ltm::Snapshot class_of(const std::string& name, const std::string& shape, double x_m,
                              double y_m, double z_m, Time time = kBegin) {
  return {class_id(name),
          time,
          {{idf::Dict{{"name", name},
                      {"spoken_name", name},
                      {"shape", shape},
                      {"size", idf::NdArray::take<double>({3}, {x_m, y_m, z_m})}},
            {}}}};
}

/// A thing of a class, with its middle at a height.
inline ltm::Snapshot thing_at(const std::string& name, const std::string& of_class,
                              const PlanarPose& pose, double z_m, Time time,
                              const std::string& held_by = {}) {
  return {thing_id(name),
          time,
          {{idf::Dict{{"object_class", class_id(of_class).to_data()},
                      {"pose_world_object", pose_data(pose, z_m)},
                      {"held_by", held_by}},
            {}}}};
}

inline ltm::Snapshot surface_at(const std::string& name, const PlanarPose& pose, double height_m,
                                double depth_m, double width_m, Time time = kBegin) {
  return {surface_id(name),
          time,
          {{idf::Dict{{"name", name},
                      {"pose_world_surface", pose_data(pose, height_m)},
                      {"depth", depth_m},
                      {"width", width_m}},
            {}}}};
}

}  // namespace engram::navigation::testing
