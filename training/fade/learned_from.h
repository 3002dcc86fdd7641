// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <set>

#include "encoders/deep_model.h"
#include "ltm/store/rewrite.h"
#include "ltm/store/store_reader.h"

// Private to this room: includes LibTorch.

namespace engram::training {

/// What a model has of snapshots that are erased.
struct Learned {
  /// Whether its weights or its numbers may depend on them: it has to go.
  bool is_tainted = false;
  /// Hashes of the pictures of them that videos begin from.
  std::set<uint64_t> references;
};

/// Whether nothing that a model has learned depends on any image or number: it has no networks and
/// codes no numbers. Then its latents decode alike with a copy of it that lacks some references.
[[nodiscard]] bool knows_no_content(const encoders::DeepModel& model);

/// What a model of `entity` has of `gone`. What it was conditioned on counts as well.
[[nodiscard]] Learned learned_from(const encoders::DeepModel& model, const ltm::MemoryId& entity,
                                   const ltm::ForgetSet& gone);

/// What it may have of snapshots that were forgotten before: of any since it was trained.
/// Errors: those of reading.
Result<Learned> learned_from_forgotten(const encoders::DeepModel& model,
                                       const ltm::MemoryId& entity, ltm::StoreReader& reader);

/// Snapshots of `entity` and of what conditions its model that are forgotten.
[[nodiscard]] int64_t forgotten_for(const encoders::DeepModel& model, const ltm::MemoryId& entity,
                                    const ltm::Manifest& manifest);

/// Whether the videos of a block begin from one of `references`.
/// Errors: kDataLoss.
Result<bool> begins_from(const ltm::Latent& latent, size_t images,
                         const std::set<uint64_t>& references);

}  // namespace engram::training
