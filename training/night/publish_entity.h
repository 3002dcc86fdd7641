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

/// The temporary file of a new model until it is published.
///
/// It owns the file.
struct ModelFile {
  ltm::TemporaryFile file;
  uint64_t bytes = 0;
};

/// Writes a model with the forms in which its snapshots were kept. It is written before the
/// comparison of models, which needs its size; publish_new_model then adds the result.
/// Errors: the errors of the store and of save_model.
Result<ModelFile> write_model_file(const EntityWork& work, encoders::DeepModel& model);

/// Publishes a new model with its latents and the choice between models, after its file was read
/// back and passed its self test.
/// Errors: the errors of note_choice, read_model and publish_model.
Status publish_new_model(const EntityWork& work, int version, const ModelFile& model,
                         const encoders::ModelChoice& choice,
                         const std::vector<ltm::LatentSnapshot>& latents);

/// Publishes latents of a model that the store has. There must be at least one.
/// Errors: the errors of publish_latents.
Status publish_more_latents(const EntityWork& work, int version,
                            const std::vector<ltm::LatentSnapshot>& latents);

}  // namespace engram::training
