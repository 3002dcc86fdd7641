// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "training/fit/train_options.h"
#include "training/forms/representation.h"
#include "training/night/entity_work.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::training {

/// How the images of an entity will be kept, and what is trained for that.
struct ChosenForm {
  TrainOptions train;  ///< With networks for images, and how wide, or without.
  RepresentationOptions representation;
  std::vector<std::string> notes;  ///< Why, in sentences.

  /// The same without networks: video at the bound.
  [[nodiscard]] ChosenForm as_video_alone() const;
};

/// Chooses between networks and video alone, before anything is trained: whether networks for
/// images could save five times their bytes, if their latents took none at all, beside some evenly
/// spaced runs of images as video. Chooses their width where nobody did.
/// Errors: those of the store and of the codecs.
/// Source: docs/learning.md, section "What is stored: latents or video".
Result<ChosenForm> choose_form(const EntityWork& work, const PlannedEntity& planned);

}  // namespace engram::training
