// SPDX-License-Identifier: Apache-2.0
#include "training/fade/erase.h"

#include <set>

#include "training/fade/erase_entity.h"

namespace engram::training {

Result<ltm::Erasures> code_anew(const std::filesystem::path& store, const ltm::ForgetSet& gone,
                                const ProgressSink& progress, const std::stop_token& stop) {
  // Entities without a model have no latents: there is nothing to do but to forget.
  std::set<ltm::MemoryId> entities;
  ENGRAM_ASSIGN_OR_RETURN(const ltm::Manifest manifest, ltm::read_manifest(store));
  for (const ltm::ModelInfo& model : manifest.models) entities.insert(model.entity);
  ltm::Erasures erased;
  for (const ltm::MemoryId& entity : entities) {
    EntityErasing erasing(store, entity, gone, progress, stop);
    const auto is_needed = erasing.open();
    Status status = is_needed.status();
    if (status.ok() && !*is_needed) continue;
    if (status.ok()) status = erasing.run();
    if (status.code() == StatusCode::kCancelled) return status;
    if (!status.ok()) return status.with_context("erasing from '" + entity.to_string() + "'");
    erased[entity] = std::move(erasing.report());
  }
  return erased;
}

}  // namespace engram::training
