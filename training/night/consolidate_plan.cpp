// SPDX-License-Identifier: Apache-2.0
#include "training/night/consolidate_plan.h"

namespace engram::training {

std::optional<double> EntityPlan::expected_bytes() const {
  if (!latent_bytes_per_snapshot) return std::nullopt;
  return *latent_bytes_per_snapshot * static_cast<double>(snapshots) +
         static_cast<double>(model_bytes);
}

std::optional<double> EntityPlan::expected_gain_bytes() const {
  const auto expected = expected_bytes();
  if (!expected) return std::nullopt;
  return static_cast<double>(stored_bytes) - *expected;
}

void describe_newest_model(const ltm::Manifest& manifest, EntityPlan& plan) {
  if (const ltm::ModelInfo* newest = manifest.newest_model(plan.entity)) {
    plan.newest_version = newest->version;
    plan.model_bytes = newest->bytes;
  }
  uint64_t snapshots = 0;
  uint64_t bytes = 0;
  for (const ltm::SegmentInfo& segment : manifest.segments) {
    const ltm::SegmentEntity* entity = segment.find(plan.entity);
    if (segment.kind != ltm::SegmentKind::kLatent || entity == nullptr ||
        entity->latent.model_version != plan.newest_version)
      continue;
    snapshots += entity->snapshots;
    bytes += entity->stored_bytes;
  }
  if (snapshots > 0)
    plan.latent_bytes_per_snapshot = static_cast<double>(bytes) / static_cast<double>(snapshots);
}

}  // namespace engram::training
