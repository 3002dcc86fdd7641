// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: pictures of a world that moves on.

#include <memory>
#include <vector>

#include "datasets/kitchen/robot_bus.h"
#include "datasets/kitchen/world.h"

namespace engram::datasets::kitchen {

/// Draws in a thread of its own what the cameras see, from a twin of the world: a picture takes
/// longer than a sample, and the world must not wait for it.
///
/// Threading: thread-safe; pictures are drawn one after the other.
class Stage {
 public:
  /// Errors: those of World::twin and Renderer::create.
  static Result<std::unique_ptr<Stage>> open(const World& world, const DrawingSize& size);
  ~Stage();
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Draws the world with these coordinates (World::coordinates), which are those of a sample.
  BodyPicture draw(const std::vector<double>& coordinates, uint64_t sample);

 private:
  struct Parts;
  explicit Stage(std::unique_ptr<Parts> parts);

  std::unique_ptr<Parts> parts_;
};

}  // namespace engram::datasets::kitchen
