// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "augmentation/blender/scene.h"
#include "augmentation/random.h"
#include "augmentation/recipe.h"

namespace engram::augmentation {

/// How a scene is changed before it is rendered.
enum class SceneChangeKind {
  kOriginal,  ///< The scene is not changed.
  kRecolour,  ///< A thing has another colour.
  kReplace,   ///< Another thing of the scene stands in the place of a thing.
  kView,      ///< The camera has another position and orientation.
  kLight,     ///< Lamps are brighter or darker, warmer or colder.
};

/// Returns all kinds in the order of their declaration.
[[nodiscard]] const std::vector<SceneChangeKind>& all_scene_changes();

/// Returns "original", "recolour", "replace", "view" or "light". Recipes prefix it with "scene_".
[[nodiscard]] const char* to_string(SceneChangeKind kind);

/// Errors: kInvalidArgument naming the text and the kinds that exist.
Result<SceneChangeKind> parse_scene_change(std::string_view text);

/// Draws a change of this kind. Returns nothing if the kind needs a thing in sight and there is
/// none, or needs another thing to take its place and there is none. Which thing is changed depends
/// only on `random` and on the things in sight. `strength_percent`: 1 to 100.
/// Source: docs/augmentation.md, section "Moments rendered anew".
std::optional<Change> draw_scene_change(SceneChangeKind kind, const Scene& scene,
                                        const std::vector<std::string>& things_in_sight,
                                        int strength_percent, Random& random);

/// Applies a change that was drawn. The cameras of a rig move together: `rig` is the pose of one of
/// them and must be the same for all. Errors: kInvalidArgument naming the parameter, or the change
/// if it does not change scenes; kNotFound if the scene has no such thing.
Status change_scene(Scene& scene, const Change& change, const PartPose& rig);

/// Returns the same camera with fewer pixels, so that its image is at most `width` pixels wide.
[[nodiscard]] SceneCamera scaled_down(const SceneCamera& camera, int width);

}  // namespace engram::augmentation
