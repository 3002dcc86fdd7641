// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ltm/memory/memory_id.h"
#include "ltm/store/manifest.h"

namespace engram::training {

/// Least PSNR of every image, and where it comes from.
struct ImageBound {
  double bound_db = 0;       ///< 0: there are no images, or they are kept as latents alone.
  int64_t noise_images = 0;  ///< Whose noise it follows from; 0: it was given.
  double noise = 0;          ///< Their standard deviation. Unit: grey levels.
};

/// What the offline phase is going to do with one entity.
struct EntityPlan {
  ltm::MemoryId entity;
  std::string skipped_reason;  ///< Empty where the entity will be worked on.
  uint64_t snapshots = 0;      ///< Recorded ones that will get latents.
  uint64_t new_snapshots = 0;  ///< Of these, the ones that have none yet.
  uint64_t plain_bytes = 0;    ///< Of `snapshots`.
  uint64_t stored_bytes = 0;   ///< Of the recorded form of the entity, as it is now.
  double budget_share = 0;     ///< Of the time that all entities share, 0 to 1.
  int newest_version = 0;      ///< Of its models; 0 where it has none.
  /// What a snapshot takes as latents of the newest model in the store, the segment around them
  /// included; nothing where there are none.
  std::optional<double> latent_bytes_per_snapshot;
  uint64_t model_bytes = 0;  ///< Of the newest model's file.
  ImageBound bound;

  /// What latents and model will take if they turn out as those of the newest model.
  [[nodiscard]] std::optional<double> expected_bytes() const;
  /// How many bytes fewer the store has once the recorded form is dropped, if so; may be negative.
  [[nodiscard]] std::optional<double> expected_gain_bytes() const;
};

struct ConsolidatePlan {
  std::vector<EntityPlan> entities;  ///< In the order of their names.
};

/// Fills in what the store knows of the newest model of `plan.entity`.
void describe_newest_model(const ltm::Manifest& manifest, EntityPlan& plan);

}  // namespace engram::training
