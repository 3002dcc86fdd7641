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

/// A change that recipes may have, and how far it may go.
struct ChangeChoice {
  const ImageChange* kind = nullptr;
  int strength_percent = 50;  ///< 1 to 100.
};

/// Reads "brightness", "rotate:80": a name and, behind a colon, its strength.
/// Errors: kInvalidArgument.
Result<ChangeChoice> parse_change_choice(std::string_view text, int strength_percent);

/// All changes that need no mask, and with `has_mask` the others too.
[[nodiscard]] std::vector<ChangeChoice> usual_changes(int strength_percent, bool has_mask);

/// Each of the choices with a probability of one half, at least one; in the order of the registry.
/// `choices` not empty (checked). What changes an object changes that of `label`.
[[nodiscard]] Recipe draw_recipe(std::span<const ChangeChoice> choices, int64_t label,
                                 Random& random);

/// Gives changes that have a seed another one: neighbouring snapshots share a recipe, not its
/// noise.
[[nodiscard]] Recipe with_seed(Recipe recipe, uint64_t seed);

/// Which members of a value are not what they look like.
struct SceneMembers {
  /// Images whose pixels are labels of objects: they move, and their values stay.
  std::vector<std::string> labels;
  /// Arrays of float32 or float64 whose last axis is x, y, x, y, ... in pixels of the first image:
  /// they move along.
  std::vector<std::string> points;
};

/// Whether a value has images that recipes can change.
[[nodiscard]] bool has_images(const idf::Layout& layout);

/// The same value with its images changed, and all that belongs to them. `type` null: none is
/// known. `labels` are those of another entity, at the same moment; of the images' aspect ratio.
/// Errors: kInvalidArgument naming the member or the change, what was found and what was needed.
Result<idf::Data> augmented(const idf::Data& value, const idf::Type* type, const Recipe& recipe,
                            const SceneMembers& members,
                            const std::optional<idf::NdArray>& labels = {});

}  // namespace engram::augmentation
