// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "encoders/provenance.h"
#include "training/night/choose_form.h"
#include "training/night/encode_entity.h"
#include "training/night/entity_work.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::training {

/// The comparison of a new model with the one before it.
struct ComparedModels {
  encoders::ModelChoice choice;    ///< Has no previous version if there was none to compare with.
  std::vector<std::string> notes;  ///< The result, or why nothing was compared, in sentences.
  /// The encoding by the previous model of the snapshots that had no latents of it within the
  /// bound; nothing if it was not compared.
  std::optional<EncodedEntity> previous;
};

/// Returns the reason, as a sentence, if networks with the cheapest mix of latents and video take
/// more bytes than video alone over `nights` nights.
[[nodiscard]] std::optional<std::string> why_video_is_cheaper(const EncodedEntity& made,
                                                              uint64_t model_bytes, int nights);

/// Compares continuing with the newest model of the store to the new model, which encoded `made`
/// and takes `model_bytes`. The newest model encodes the snapshots that have no latents of it yet.
/// Where the time does not suffice for that, or did not for `made`, nothing is compared.
/// Errors: the errors of the store and of encoding.
Result<ComparedModels> compare_models(const EntityWork& work, const PlannedEntity& planned,
                                      const ChosenForm& form, const EncodedEntity& made,
                                      uint64_t model_bytes, const EncodingLimits& limits);

}  // namespace engram::training
