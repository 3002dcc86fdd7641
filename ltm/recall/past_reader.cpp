// SPDX-License-Identifier: Apache-2.0
#include "ltm/recall/past_reader.h"

#include "ltm/core/log.h"

namespace engram::ltm {

namespace {

bool uses_latent(const SnapshotEntry& entry, Prefer prefer) {
  return entry.latent && (!entry.recorded || prefer == Prefer::kLatent);
}

}  // namespace

Result<const LoadedModel*> LoadedModels::load(const std::filesystem::path& store,
                                              const ModelInfo& info) {
  if (const auto known = models_.find(info.file); known != models_.end()) return &known->second;
  if (const auto failed = failed_.find(info.file); failed != failed_.end()) return failed->second;
  if (!loader_)
    return failed_precondition("model {}: this program was built without learning", info.name());
  auto model = loader_(store / info.file);
  if (!model.ok()) {
    Status status = model.status().with_context("model " + info.name());
    if (!is_damage(status)) return status;
    log::warning("{}; what was recorded and copies of the last snapshot answer without it",
                 status.message());
    ++damaged_;
    failed_.emplace(info.file, status);
    return status;
  }
  return &models_.emplace(info.file, std::move(model).value()).first->second;
}

bool is_damage(const Status& status) {
  return status.code() == StatusCode::kDataLoss || status.code() == StatusCode::kNotFound;
}

Result<SnapshotResult> PastReader::read(const MemoryId& entity, const SnapshotEntry& entry,
                                        Prefer prefer) {
  if (!uses_latent(entry, prefer)) return read_recorded(entity, entry);
  auto found = reconstruct(entity, entry);
  if (!entry.recorded || !is_damage(found.status())) return found;
  models_->note_substituted();
  return read_recorded(entity, entry);
}

Result<SnapshotResult> PastReader::name(const MemoryId& entity, const SnapshotEntry& entry,
                                        Prefer prefer) {
  const bool is_latent = uses_latent(entry, prefer);
  size_t count = is_latent ? entry.latent->rows : entry.recorded->rows;
  if (count == 0 && !is_latent) {
    ENGRAM_ASSIGN_OR_RETURN(const PackedSnapshot packed, store_->read_packed(entity, entry));
    count = packed.instances.size();
  }
  SnapshotResult named;
  named.time = entry.time;
  named.source = is_latent ? Source::kReconstructed : Source::kRecorded;
  if (!is_latent) {
    ENGRAM_ASSIGN_OR_RETURN(const bool is_augmented, store_->is_augmented(entity, entry));
    if (is_augmented) named.source = Source::kAugmented;
  }
  for (size_t i = 0; i < count; ++i) named.append({}, {});
  return named;
}

Result<const ModelInfo*> PastReader::find_model(const MemoryId& entity, int version) const {
  for (const ModelInfo& model : store_->manifest().models)
    if (model.entity == entity && model.version == version) return &model;
  return data_loss("store '{}': latents of '{}' name model v{}, which is not there",
                   store_->path().string(), entity.to_string(), version);
}

Result<SnapshotResult> PastReader::read_recorded(const MemoryId& entity,
                                                 const SnapshotEntry& entry) {
  ENGRAM_ASSIGN_OR_RETURN(Snapshot snapshot, store_->read_recorded(entity, entry));
  SnapshotResult recalled;
  recalled.time = snapshot.time;
  if (snapshot.is_augmented()) recalled.source = Source::kAugmented;
  for (Instance& instance : snapshot.instances)
    recalled.append(std::move(instance.data), instance.metadata);
  return recalled;
}

Result<SnapshotResult> PastReader::reconstruct(const MemoryId& entity, const SnapshotEntry& entry) {
  ENGRAM_ASSIGN_OR_RETURN(const LatentSnapshot latents, store_->read_latent(entity, entry));
  ENGRAM_ASSIGN_OR_RETURN(const ModelInfo* info, find_model(entity, latents.model_version));
  ENGRAM_ASSIGN_OR_RETURN(const LoadedModel* model, load(*info));
  SnapshotResult recalled;
  recalled.source = Source::kReconstructed;
  recalled.model = info->name();
  recalled.time = entry.time;
  std::vector<Latent> codes;
  for (const LatentInstance& instance : latents.instances) codes.push_back(instance.latent);
  auto values = model->encoder->decode(codes);
  if (!values.ok())
    return values.status().with_context(entity.at(entry.time).to_string() + ", " + info->name());
  if (values->size() != codes.size())
    return data_loss("model {}: gave {} values for {} latents", info->name(), values->size(),
                     codes.size());
  for (size_t i = 0; i < latents.instances.size(); ++i)
    recalled.append(std::move((*values)[i]), latents.instances[i].metadata,
                    latents.instances[i].quality.error, latents.instances[i].quality.bound);
  return recalled;
}

}  // namespace engram::ltm
