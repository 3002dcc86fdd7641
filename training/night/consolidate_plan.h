// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ltm/memory/memory_id.h"
#include "ltm/store/manifest.h"

namespace engram::training {

/// Min PSNR of every image, and its origin.
struct ImageBound {
  double bound_db = 0;       ///< 0 if there are no images, or they are kept as latents alone.
  int64_t noise_images = 0;  ///< Images that the noise was measured on; 0 if the bound was given.
  double noise = 0;          ///< Standard deviation of the noise. Unit: grey levels.
};

/// The plan of the offline phase for one entity.
struct EntityPlan {
  ltm::MemoryId entity;
  std::string skipped_reason;  ///< Empty if the entity will be processed.
  uint64_t snapshots = 0;      ///< Recorded snapshots that will get latents.
  uint64_t new_snapshots = 0;  ///< Those of them without latents.
  uint64_t plain_bytes = 0;    ///< Plain size of `snapshots`.
  uint64_t stored_bytes = 0;   ///< Current size of the recorded form of the entity.
  double budget_share = 0;     ///< Share of the time of all entities, 0 to 1.
  int newest_version = 0;      ///< Version of its newest model; 0 if it has none.
  /// Bytes of a snapshot as latents of the newest model in the store, including the segment around
  /// them; nothing if there are none.
  std::optional<double> latent_bytes_per_snapshot;
  uint64_t model_bytes = 0;  ///< Size of the newest model's file.
  ImageBound bound;

  /// Expected size of latents and model, if they are like those of the newest model.
  [[nodiscard]] std::optional<double> expected_bytes() const;
  /// Expected reduction of the store after the recorded form is dropped; may be negative.
  [[nodiscard]] std::optional<double> expected_gain_bytes() const;
};

struct ConsolidatePlan {
  std::vector<EntityPlan> entities;  ///< Sorted by name.
};

/// Fills in the facts about the newest model of `plan.entity` in the store.
void describe_newest_model(const ltm::Manifest& manifest, EntityPlan& plan);

}  // namespace engram::training
