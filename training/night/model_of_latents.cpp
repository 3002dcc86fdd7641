// SPDX-License-Identifier: Apache-2.0
#include "training/night/model_of_latents.h"

namespace engram::training {

int version_of_latents(const EntityWork& work, const ltm::SnapshotEntry& entry) {
  if (!entry.latent) return 0;  // Journals hold no latents.
  const auto* entity = work.reader.manifest().segments[entry.latent->source].find(work.entity);
  return entity == nullptr ? 0 : entity->latent.model_version;
}

}  // namespace engram::training
