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

/// What is done to a scene before it is rendered.
enum class SceneChangeKind {
  kOriginal,  ///< Nothing.
  kRecolour,  ///< A thing has another colour.
  kReplace,   ///< A thing stands where another one stood.
  kView,      ///< The camera stands and looks elsewhere.
  kLight,     ///< Lamps are brighter or darker, warmer or colder.
};

/// In the order of their declaration.
[[nodiscard]] const std::vector<SceneChangeKind>& all_scene_changes();

/// "original", "recolour", "replace", "view", "light"; in recipes with "scene_" before it.
[[nodiscard]] const char* to_string(SceneChangeKind kind);

/// Errors: kInvalidArgument naming the text and the kinds there are.
Result<SceneChangeKind> parse_scene_change(std::string_view text);

/// A change of that kind as data; nothing where it needs a thing in sight and there is none, or no
/// other one to take its place. Which thing is changed depends on `random` and on which are in
/// sight: as long as the same ones are, it is the same. `strength_percent`: 1 to 100.
/// Source: docs/augmentation.md, section "Moments rendered anew".
std::optional<Change> draw_scene_change(SceneChangeKind kind, const Scene& scene,
                                        const std::vector<std::string>& things_in_sight,
                                        int strength_percent, Random& random);

/// Makes a change that was drawn. Cameras of one rig move with it: `rig` is the pose of one of
/// them, the same for all. Errors: kInvalidArgument naming the parameter, or a change that is none
/// of scenes; kNotFound where the scene has no such thing.
Status change_scene(Scene& scene, const Change& change, const PartPose& rig);

/// The same camera with fewer pixels, so that its image is `width` wide at most.
[[nodiscard]] SceneCamera scaled_down(const SceneCamera& camera, int width);

}  // namespace engram::augmentation
