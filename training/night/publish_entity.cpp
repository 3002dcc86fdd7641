// SPDX-License-Identifier: Apache-2.0
#include "training/night/publish_entity.h"

#include <filesystem>
#include <utility>

#include "encoders/deep_model_file.h"
#include "ltm/store/publish.h"

namespace engram::training {

Result<ModelFile> write_model_file(const EntityWork& work, encoders::DeepModel& model) {
  const auto stage = work.stage(Stage::kPublishing);
  ENGRAM_ASSIGN_OR_RETURN(auto file, ltm::TemporaryFile::create(work.reader.path(), ".model.h5"));
  ENGRAM_RETURN_IF_ERROR(encoders::save_model(model, file.path()));
  std::error_code failed;
  const uint64_t bytes = std::filesystem::file_size(file.path(), failed);
  if (failed) return unavailable("model '{}': {}", file.path().string(), failed.message());
  return ModelFile{std::move(file), bytes};
}

// Snapshots that were recorded or forgotten since this generation was read are not affected.
Status publish_new_model(const EntityWork& work, int version, const ModelFile& model,
                         const encoders::ModelChoice& choice,
                         const std::vector<ltm::LatentSnapshot>& latents) {
  const auto stage = work.stage(Stage::kPublishing);
  if (choice.previous_version > 0)
    ENGRAM_RETURN_IF_ERROR(encoders::note_choice(choice, model.file.path()));
  // Latents without a model that decodes them would be lost, so the file is read back once before
  // it is published.
  ENGRAM_RETURN_IF_ERROR(encoders::read_model(model.file.path()).status());
  return ltm::publish_model(work.reader.path(), work.entity, version, model.file.path(), latents,
                            work.reader.manifest().first_journal);
}

Status publish_more_latents(const EntityWork& work, int version,
                            const std::vector<ltm::LatentSnapshot>& latents) {
  const auto stage = work.stage(Stage::kPublishing);
  return ltm::publish_latents(work.reader.path(), work.entity, version, latents,
                              work.reader.manifest().first_journal);
}

}  // namespace engram::training
