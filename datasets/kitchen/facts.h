// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what is known of the kitchen at a moment, as values. Recordings and live
// drivers use them, so that both give the same.

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "datasets/kitchen/model_text.h"
#include "datasets/kitchen/robot_body.h"
#include "ltm/idf/ndarray.h"
#include "ltm/memory/memory_id.h"

namespace engram::datasets::kitchen::facts {

[[nodiscard]] idf::Data recording(uint64_t seed, double seconds, const DrawingSize& size,
                                  const Lighting& light);
[[nodiscard]] idf::Data calibration(Side side, const DrawingSize& size,
                                    const Pose& pose_head_camera);
/// `lower` and `upper`: the ranges of the 43 joints.
[[nodiscard]] idf::Data description(std::span<const double> lower, std::span<const double> upper,
                                    const std::string& urdf);
[[nodiscard]] idf::Data surface(Surface surface);
[[nodiscard]] idf::Data object_class(const ThingClass& type);

[[nodiscard]] idf::Data joints(const RobotVector& positions, const RobotVector& velocities);
[[nodiscard]] idf::Data platform(const RobotVector& positions, const RobotVector& velocities);

/// What belongs to the time of a snapshot. Each is an instance.
struct Links {
  std::optional<ltm::MemoryId> image{};  ///< The left image; empty: nothing was drawn.
  ltm::MemoryId joints;
  ltm::MemoryId platform;
};

/// Shape of `image`: uint8 [height, width, 3], RGB.
[[nodiscard]] idf::Data view(const idf::NdArray& image, const Pose& pose_world_camera,
                             const ltm::MemoryId& calibration, const Links& links);
/// `colour`: empty: the value has no such member.
[[nodiscard]] idf::Data object(const ltm::MemoryId& object_class, const Pose& pose, bool is_visible,
                               std::string_view held_by, const Links& links,
                               std::string_view colour = {});

}  // namespace engram::datasets::kitchen::facts
