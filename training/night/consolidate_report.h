// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "encoders/provenance.h"
#include "ltm/likeness/make_codes.h"
#include "ltm/memory/memory_id.h"
#include "ltm/saliency/make_saliency.h"
#include "training/fit/train_report.h"
#include "training/night/entity_costs.h"

namespace engram::training {

/// The result of the offline phase for one entity.
struct EntityReport {
  ltm::MemoryId entity;
  std::string skipped_reason;  ///< Empty if latents were published or could stay.
  int model_version = 0;       ///< Version of the model of the published latents.
  bool is_model_new = false;   ///< If not, the previous model was kept and the new one discarded.
  uint64_t snapshots = 0;      ///< Recorded snapshots that got latents of that model.
  /// Recorded snapshots that wait for a later night, because the time was over.
  uint64_t waiting = 0;
  uint64_t left_behind = 0;   ///< Recorded snapshots of another layout, which stay unchanged.
  uint64_t raw_bytes = 0;     ///< Plain size of the encoded snapshots.
  uint64_t stored_bytes = 0;  ///< Size of the recorded form of the entity.
  uint64_t latent_bytes = 0;  ///< Codes and remainders, without the segment around them.
  uint64_t model_bytes = 0;
  double mean_psnr_db = 0;  ///< NaN without images, like the next three.
  double pooled_psnr_db = 0;
  double minimum_psnr_db = 0;
  /// Quantiles of the PSNR of images: 5 %, 50 % and 95 %.
  std::array<double, 3> psnr_quantiles_db{};
  double rmse = 0;                 ///< NaN without numbers.
  encoders::StoredForms forms;     ///< The forms in which images were kept.
  encoders::ModelChoice choice;    ///< Between the new model and the one before it.
  std::vector<std::string> notes;  ///< Reasons, in sentences.
  double seconds = 0;
  double encoding_seconds = 0;           ///< Part of `seconds`: encoding, decoding and comparing.
  double expected_encoding_seconds = 0;  ///< Estimate from a sample; 0 if it was not measured.
  EntityCosts costs;
  TrainReport training;
};

struct ConsolidateReport {
  Time began{};  ///< Names the night in the store's records (ltm/store/night_records.h).
  std::vector<EntityReport> entities;  ///< Sorted by name.
  /// Of the entities with images: what was done so that moments like others are found.
  std::vector<ltm::EntityCoding> codes;
  ltm::SaliencyReport saliency;
};

}  // namespace engram::training
