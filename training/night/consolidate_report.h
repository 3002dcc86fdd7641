// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "encoders/provenance.h"
#include "ltm/memory/memory_id.h"
#include "training/fit/train_report.h"

namespace engram::training {

/// What became of one entity.
struct EntityReport {
  ltm::MemoryId entity;
  std::string skipped_reason;  ///< Empty where latents were published, or could stay as they are.
  int model_version = 0;       ///< Whose latents were published.
  bool is_model_new = false;   ///< Else it is the one that was there, and `training` is discarded.
  uint64_t snapshots = 0;      ///< Recorded ones that got latents of that model.
  uint64_t left_behind = 0;    ///< Recorded ones of another layout: they stay as they are.
  uint64_t raw_bytes = 0;      ///< Of the encoded snapshots, plain.
  uint64_t stored_bytes = 0;   ///< Of the recorded form of the entity.
  uint64_t latent_bytes = 0;   ///< Codes and remainders, without the segment around them.
  uint64_t model_bytes = 0;
  double mean_psnr_db = 0;  ///< NaN without images, like the next three.
  double pooled_psnr_db = 0;
  double minimum_psnr_db = 0;
  /// That 5 %, half and 95 % of the images are below.
  std::array<double, 3> psnr_quantiles_db{};
  double rmse = 0;                 ///< NaN without numbers.
  encoders::StoredForms forms;     ///< How the images were kept.
  encoders::ModelChoice choice;    ///< Between the new model and the one before it.
  std::vector<std::string> notes;  ///< Why, in sentences.
  double seconds = 0;
  double encoding_seconds = 0;           ///< Of `seconds`: encoding, decoding and comparing.
  double expected_encoding_seconds = 0;  ///< As measured on a sample; 0 where it was not.
  TrainReport training;
};

struct ConsolidateReport {
  std::vector<EntityReport> entities;  ///< In the order of their names.
};

}  // namespace engram::training
