// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "datasets/kitchen/kitchen_scene.h"
#include "datasets/scenes/scene_source.h"

namespace engram::datasets {

/// Reconstructs what cameras saw from stores of kitchen recordings: from views, everything that
/// they link to, and all objects. A moment is complete if each object was recorded at exactly that
/// time, or rested: no hand held it, and it was at the same place before and after.
class KitchenSceneSource final : public SceneSource {
 public:
  [[nodiscard]] std::string name() const override { return "a simulated kitchen"; }

  /// Errors: those of the store; kInvalidArgument for values that do not have their types.
  Result<std::optional<RememberedScene>> scene(ltm::StoreReader& store,
                                               const ltm::Snapshot& snapshot,
                                               size_t index) override;

  [[nodiscard]] Result<idf::Data> seen(const idf::Data& recorded,
                                       const augmentation::SceneCamera& camera,
                                       const idf::NdArray& image) const override;

 private:
  KitchenScenes scenes_;
};

}  // namespace engram::datasets
