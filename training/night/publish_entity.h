// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "encoders/provenance.h"
#include "ltm/store/latent.h"
#include "ltm/store/temporary_file.h"
#include "training/night/entity_work.h"
#include "training/night/plan_entity.h"

// Private to this room.

namespace engram::encoders {
struct DeepModel;
}

namespace engram::training {

/// The file of a model that was made, beside the store's own until it is published.
///
/// Owns: the file.
struct ModelFile {
  ltm::TemporaryFile file;
  uint64_t bytes = 0;
};

/// Writes a model, with how its snapshots were kept, once: how many bytes it takes is a part of
/// what it is compared by, and publish_new_model fills in what came of that.
/// Errors: those of the store and of save_model.
Result<ModelFile> write_model_file(const EntityWork& work, const PlannedEntity& planned,
                                   encoders::DeepModel& model);

/// Publishes a new model with its latents, and what it was chosen over, after its file was read
/// back and passed its self test.
/// Errors: those of note_choice, read_model and publish_model.
Status publish_new_model(const EntityWork& work, int version, const ModelFile& model,
                         const encoders::ModelChoice& choice,
                         const std::vector<ltm::LatentSnapshot>& latents);

/// Publishes latents of a model that the store has; at least one.
/// Errors: those of publish_latents.
Status publish_more_latents(const EntityWork& work, int version,
                            const std::vector<ltm::LatentSnapshot>& latents);

}  // namespace engram::training
