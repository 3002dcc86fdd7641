// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "augmentation/image_change.h"
#include "augmentation/recipe.h"
#include "ltm/core/time.h"
#include "ltm/idf/data.h"
#include "ltm/idf/layout.h"

namespace engram::augmentation {

/// A change that recipes may contain, with a bound on how far it may go.
struct ChangeChoice {
  const ImageChange* kind = nullptr;
  /// The share of the full range that parameters are drawn from. Unit: percent, 1 to 100.
  int strength_percent = 50;
};

/// Parses "brightness" or "rotate:80": the name of a change, optionally followed by a colon and its
/// strength. `strength_percent` is used if the text gives none. Errors: kInvalidArgument.
Result<ChangeChoice> parse_change_choice(std::string_view text, int strength_percent);

/// Returns all changes that need no mask, and also those that need one if `has_mask` is true.
[[nodiscard]] std::vector<ChangeChoice> usual_changes(int strength_percent, bool has_mask);

/// Draws a recipe. It contains each choice with a probability of one half, but at least one, in the
/// order of the registry. `choices` must not be empty (checked). Changes of an object change the
/// one with number `label`.
[[nodiscard]] Recipe draw_recipe(std::span<const ChangeChoice> choices, int64_t label,
                                 Random& random);

/// Replaces the seed of every change that has one. Neighbouring snapshots share a recipe, but must
/// not share its noise.
[[nodiscard]] Recipe with_seed(Recipe recipe, uint64_t seed);

/// Names the members of a value that are not ordinary images or numbers.
struct SceneMembers {
  /// Images whose pixels are labels of objects. They move with the view; their values stay.
  std::vector<std::string> labels;
  /// Arrays of float32 or float64 whose last axis is x, y, x, y, ... in pixels of the first image.
  /// They move with the view.
  std::vector<std::string> points;
};

/// Returns true if a value has images that recipes can change.
[[nodiscard]] bool has_images(const idf::Layout& layout);

/// Returns a copy of `value` in which the images, and all members that belong to them, are changed.
/// `type` is null if the type of the value is not known. `labels` is the label image of another
/// entity at the same moment, with the aspect ratio of the images.
/// Errors: kInvalidArgument naming the member or the change, what was found and what was needed.
Result<idf::Data> augmented(const idf::Data& value, const idf::Type* type, const Recipe& recipe,
                            const SceneMembers& members,
                            const std::optional<idf::NdArray>& labels = {});

}  // namespace engram::augmentation
