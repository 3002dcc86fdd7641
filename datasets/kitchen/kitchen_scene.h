// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "augmentation/blender/scene.h"
#include "ltm/core/status.h"
#include "ltm/idf/data.h"
#include "ltm/memory/memory_id.h"

namespace engram::datasets {

/// What a kitchen recording remembers of one moment: the values as they were recorded.
struct KitchenMoment {
  idf::Data recording;    ///< kitchen::Recording.
  idf::Data calibration;  ///< kitchen::CameraCalibration of the camera.
  idf::Data view;         ///< kitchen::View of the same camera.
  idf::Data joints;       ///< kitchen::JointState.
  idf::Data platform;     ///< kitchen::PlatformState.
  /// The entity of each object, with its kitchen::ObjectInstance.
  std::vector<std::pair<ltm::MemoryId, idf::Data>> objects;
};

/// Reconstructs remembered moments of kitchen recordings as scenes that can be rendered. A thing of
/// a scene has the name of the object's entity: "mug_1".
///
/// Threading: one thread.
/// Source: docs/kitchen.md.
class KitchenScenes {
 public:
  KitchenScenes();
  ~KitchenScenes();

  /// Errors: kInvalidArgument naming the value that does not have its type, or an object that the
  /// recording's kitchen does not have; kUnavailable if MuJoCo rejects the kitchen.
  Result<augmentation::Scene> scene(const KitchenMoment& moment);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace engram::datasets
