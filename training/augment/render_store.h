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

/// Options of rendering remembered moments.
struct RenderOptions : AugmentedStoreOptions {
  /// Kinds of changes. Each makes one image of every recorded one, in this order. There must be at
  /// least one.
  std::vector<augmentation::SceneChangeKind> kinds = augmentation::all_scene_changes();
  /// Period of rendering, counted from 1970. Of each period all moments in the first `hold` are
  /// rendered, because training needs consecutive ones, or else the first moment. Zero to render
  /// everything.
  Duration every = std::chrono::seconds(20);
  /// Max width of rendered images, which are then enlarged to the recorded size: 16 to 4096.
  int width = 320;
  augmentation::Blender::Options blender;

  [[nodiscard]] Status validate() const;
};

/// The recipe of copy `copy` of the snapshots at `time`; nothing if no object in sight can be
/// changed. It depends on nothing else.
[[nodiscard]] std::optional<augmentation::Recipe> scene_recipe_at(
    const RenderOptions& options, augmentation::SceneChangeKind kind,
    const datasets::RememberedScene& scene, Time time, int copy);

/// Makes a new store of moments that Blender renders, in one process. Entities, times, metadata and
/// instances are as in augment_store, one kind after the other. Equal options give equal images on
/// one machine.
/// Errors: the errors of Blender::start, before anything is written; the errors of augment_store.
Result<AugmentReport> render_store(const std::filesystem::path& from,
                                   const std::filesystem::path& to, const RenderOptions& options,
                                   datasets::SceneSource& scenes, const ProgressSink& progress,
                                   const std::stop_token& stop);

}  // namespace engram::training
