// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "encoders/training_variant.h"
#include "ltm/core/time.h"

namespace engram::encoders {

/// Both ends included.
struct TimeSpan {
  Time first{};
  Time last{};

  [[nodiscard]] bool contains(Time time) const { return first <= time && time <= last; }
  friend bool operator==(const TimeSpan&, const TimeSpan&) = default;
};

/// How the images of an entity were kept, and what it was chosen from. Each image member counts.
struct StoredForms {
  std::string representation;  ///< That was asked for: auto, latents or video.
  double bound_db = 0;         ///< Least PSNR of every image; 0: none was kept.
  int64_t rows = 0;
  int64_t latent_rows = 0;       ///< Kept as latents.
  int64_t video_rows = 0;        ///< Kept as video.
  int64_t lossless_rows = 0;     ///< Kept without loss.
  int64_t below_bound_rows = 0;  ///< Whose latents alone would be worse than the bound.
  int64_t kept_bytes = 0;        ///< Of the forms that were kept.
  int64_t latent_bytes = 0;      ///< Of all rows as latents; 0 without networks.
  int64_t video_bytes = 0;       ///< Of all rows as video at the bound; 0 where not tried.

  friend bool operator==(const StoredForms&, const StoredForms&) = default;
};

/// Where a model comes from.
struct Provenance {
  std::string entity;
  std::string code_version;
  uint64_t seed = 0;
  TrainingVariant variant = TrainingVariant::kRateAware;
  int64_t steps = 0;  ///< Of the optimiser, autoencoder and dynamics together.
  double training_seconds = 0;
  double final_loss = 0;
  double psnr_db = 0;       ///< That was aimed at.
  double error_price = 0;   ///< Kilobytes that a squared grey level was worth at the end; 0: unknown.
  double number_bound = 0;  ///< Of numbers; 0: one of each, relative to how far it moves.
  int64_t snapshots = 0;    ///< That the autoencoder was trained on.
  /// Recordings that the autoencoder was trained on.
  std::vector<TimeSpan> autoencoder_spans;
  /// The parts of them that the dynamics were trained on.
  std::vector<TimeSpan> dynamics_spans;

  StoredForms forms;

  friend bool operator==(const Provenance&, const Provenance&) = default;
};

}  // namespace engram::encoders
