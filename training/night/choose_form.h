// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "training/fit/train_options.h"
#include "training/forms/representation.h"
#include "training/night/entity_work.h"
#include "training/night/night_history.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::training {

/// The form in which the images of an entity will be kept, and the training for it.
struct ChosenForm {
  TrainOptions train;  ///< Includes whether there are networks for images, and their width.
  RepresentationOptions representation;
  std::vector<std::string> notes;  ///< Reasons, in sentences.
  NightHistory history;            ///< What earlier nights found out.
  size_t image_members = 0;
  int64_t image_pixels = 0;  ///< Of the largest image member.

  /// Whether all images are kept as video.
  [[nodiscard]] bool is_video_alone() const {
    return image_members > 0 && representation.kind == Representation::kVideo;
  }
  /// Whether networks may be left out: images are kept in the cheapest form, whichever that is.
  [[nodiscard]] bool may_become_video() const {
    return image_members > 0 && representation.kind == Representation::kAuto && train.has_networks;
  }
  /// The same without networks, with video at the bound.
  [[nodiscard]] ChosenForm as_video_alone() const;
  /// Searches for videos in so many times the time of a usual night: with more time for fewer
  /// bytes, with less for more. A note tells what that changes. `times` must be positive (checked).
  /// Returns how many times the usual time it will probably take.
  double spend(double times);
  /// Begins a new search for videos with what is known from earlier ones.
  void prepare_videos();
};

/// Chooses between networks and video alone before training. Networks are chosen if they could save
/// five times their own bytes compared with video, assuming that latents take no bytes. Some evenly
/// spaced runs of images are coded as video to estimate this. Their width is chosen unless it is
/// given. Networks that lost on an earlier night are not tried again before there are twice as many
/// snapshots, unless training shall start afresh or anew, or a width is given.
/// Errors: the errors of the store and of the codecs.
/// Source: docs/learning_methods.md, section "What is stored".
Result<ChosenForm> choose_form(const EntityWork& work, const PlannedEntity& planned);

}  // namespace engram::training
