// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the names of the entities in recordings.

#include <string>

#include "datasets/kitchen/things.h"
#include "ltm/memory/memory_id.h"

namespace engram::datasets::kitchen::entities {

[[nodiscard]] ltm::MemoryId recording();
[[nodiscard]] ltm::MemoryId calibration(std::string_view camera);
[[nodiscard]] ltm::MemoryId stereo();
[[nodiscard]] ltm::MemoryId depth();
[[nodiscard]] ltm::MemoryId description();
[[nodiscard]] ltm::MemoryId joints();
[[nodiscard]] ltm::MemoryId platform();
[[nodiscard]] ltm::MemoryId object_class(const ThingClass& type);
[[nodiscard]] ltm::MemoryId surface(Surface surface);
[[nodiscard]] ltm::MemoryId object(const ThingClass& type);
[[nodiscard]] ltm::MemoryId speech();
[[nodiscard]] ltm::MemoryId plan();
/// A skill of the robot, who asked for it, and what became of it.
[[nodiscard]] ltm::MemoryId executable(std::string_view skill);
[[nodiscard]] ltm::MemoryId request(std::string_view skill);
[[nodiscard]] ltm::MemoryId action(std::string_view skill);

}  // namespace engram::datasets::kitchen::entities
