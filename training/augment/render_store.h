// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>
#include <vector>

#include "augmentation/blender/blender.h"
#include "augmentation/recipe.h"
#include "augmentation/scene_change.h"
#include "datasets/scenes/scene_source.h"
#include "ltm/core/progress.h"
#include "training/augment/augmented_store.h"

namespace engram::training {

/// How remembered moments are rendered anew.
struct RenderOptions : AugmentedStoreOptions {
  /// Each makes one image of each that was recorded, in this order. Not empty.
  std::vector<augmentation::SceneChangeKind> kinds = augmentation::all_scene_changes();
  /// Of each period of so long a time, counted from 1970, what begins it is rendered: all moments
  /// of `hold`, as training learns from those that follow each other, or else the first one. Zero:
  /// everything.
  Duration every = std::chrono::seconds(20);
  /// Wider images are rendered so wide, and enlarged to what was recorded. 16 to 4096.
  int width = 320;
  augmentation::Blender::Options blender;

  [[nodiscard]] Status validate() const;
};

/// The recipe for copy `copy` of what was seen at `time`; nothing where there is no thing in sight
/// that could be changed. Depends on nothing else.
[[nodiscard]] std::optional<augmentation::Recipe> scene_recipe_at(
    const RenderOptions& options, augmentation::SceneChangeKind kind,
    const datasets::RememberedScene& scene, Time time, int copy);

/// Makes a new store of moments that Blender renders anew, all by one process. Entities, times,
/// metadata and instances are as augment_store makes them, one kind after the other. Equal options
/// make equal images on one machine.
/// Errors: those of Blender::start, before anything is written; those of augment_store.
Result<AugmentReport> render_store(const std::filesystem::path& from,
                                   const std::filesystem::path& to, const RenderOptions& options,
                                   datasets::SceneSource& scenes, const ProgressSink& progress,
                                   const std::stop_token& stop);

}  // namespace engram::training
