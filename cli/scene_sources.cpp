// SPDX-License-Identifier: Apache-2.0
#include "cli/scene_sources.h"

#include "datasets/kitchen/kitchen_scene_source.h"

namespace engram::cli {

Result<std::unique_ptr<datasets::SceneSource>> make_scene_source() {
  return std::unique_ptr<datasets::SceneSource>(std::make_unique<datasets::KitchenSceneSource>());
}

}  // namespace engram::cli
