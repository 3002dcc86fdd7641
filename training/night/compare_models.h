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

/// A new model beside the one before it.
struct ComparedModels {
  encoders::ModelChoice choice;    ///< Without a previous version: there was none to compare with.
  std::vector<std::string> notes;  ///< What was found, or why nothing was compared, in sentences.
  /// What the previous model made of the snapshots that had no latents of it within the bound;
  /// nothing where it was not compared.
  std::optional<EncodedEntity> previous;
  /// The time was over before the previous model had coded what it has to.
  std::optional<Skipped> skipped;
};

/// Whether networks and the cheapest of latents and video take more bytes, in the nights that a
/// model serves, than video alone: then why, in a sentence.
[[nodiscard]] std::optional<std::string> why_video_is_cheaper(const EncodedEntity& made,
                                                              uint64_t model_bytes, int nights);

/// Finds whether going on with the newest model of the store is worth more than the new one, which
/// made `made` and takes `model_bytes`. Codes with the former what has no latents of it yet.
/// Errors: those of the store, and of encoding but for want of time.
Result<ComparedModels> compare_models(const EntityWork& work, const PlannedEntity& planned,
                                      const ChosenForm& form, const EncodedEntity& made,
                                      uint64_t model_bytes);

}  // namespace engram::training
