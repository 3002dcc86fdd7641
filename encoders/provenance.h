// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "encoders/training_curve.h"
#include "encoders/training_variant.h"
#include "ltm/core/time.h"

namespace engram::encoders {

/// The price of squared error for a model whose file has none. Unit: kilobytes per squared grey
/// level.
inline constexpr double kUsualPrice = 0.03;

/// A span of time that includes both ends.
struct TimeSpan {
  Time first{};
  Time last{};

  [[nodiscard]] bool contains(Time time) const { return first <= time && time <= last; }
  friend bool operator==(const TimeSpan&, const TimeSpan&) = default;
};

/// The forms in which the images of an entity are kept, and the alternatives. Each image member
/// counts.
struct StoredForms {
  std::string representation;  ///< The requested one: auto, latents or video.
  double bound_db = 0;         ///< Min PSNR of every image; 0 if there was no bound.
  int64_t noise_images = 0;    ///< Images that the noise was measured on; 0 if the bound was given.
  double noise = 0;            ///< Standard deviation of the noise. Unit: grey levels.
  int64_t rows = 0;
  // Rows by the form that was kept; each row counts once.
  int64_t latent_rows = 0;    ///< As latents from the encoder.
  int64_t refined_rows = 0;   ///< As refined latents.
  int64_t residual_rows = 0;  ///< As latents, refined or not, with a residual.
  int64_t video_rows = 0;
  int64_t lossless_rows = 0;
  int64_t kept_bytes = 0;
  // Kept bytes by form. The latents of a block count evenly for its rows.
  int64_t latent_kept_bytes = 0;
  int64_t refined_kept_bytes = 0;
  int64_t residual_kept_bytes = 0;
  int64_t video_kept_bytes = 0;
  int64_t lossless_kept_bytes = 0;
  // Rows that were tried, and the bytes of all rows in one form alone; 0 if it was not tried.
  int64_t below_bound_rows = 0;   ///< Rows whose latents from the encoder miss the bound.
  int64_t refine_tried_rows = 0;  ///< Rows whose latents were refined.
  int64_t latent_bytes = 0;       ///< As latents from the encoder, whatever their error.
  int64_t residual_bytes = 0;     ///< As latents with residuals; 0 if some rows cannot be.
  int64_t video_bytes = 0;        ///< At the bound, or without loss if that is smaller.
  int64_t lossless_bytes = 0;     ///< By the chains in which it was tried; 0 if it was in none.

  friend bool operator==(const StoredForms&, const StoredForms&) = default;
};

/// Bytes of an entity in a store if it continues with one model.
struct ModelBytes {
  int64_t known = 0;  ///< Latents of snapshots that had latents before.
  int64_t news = 0;   ///< Latents of the other snapshots, with numbers and remainders.
  int64_t model = 0;  ///< The model's file, if the store would not have it otherwise.

  /// Total after `nights` nights that add as much as this one.
  [[nodiscard]] double total(int64_t nights) const {
    return static_cast<double>(known) + static_cast<double>(news) * static_cast<double>(nights) +
           static_cast<double>(model);
  }
  friend bool operator==(const ModelBytes&, const ModelBytes&) = default;
};

/// A comparison of a new model with the one before it, on the same snapshots and at the same bound.
struct ModelChoice {
  int64_t previous_version = 0;  ///< 0 if there was none to compare with.
  int64_t snapshots = 0;
  int64_t new_snapshots = 0;  ///< Snapshots that had no latents before.
  int64_t nights = 1;
  ModelBytes previous;
  ModelBytes made;

  /// The share of bytes that a new model must save to replace the one before it. It is above zero
  /// because video encoders do not always give equal bytes for equal images.
  static constexpr double kMinGain = 0.005;

  /// Whether the new model saves too little and the previous one stays.
  [[nodiscard]] bool keeps_previous() const {
    return previous_version > 0 && previous.total(nights) * (1 - kMinGain) <= made.total(nights);
  }
  friend bool operator==(const ModelChoice&, const ModelChoice&) = default;
};

/// The origin of a model: what it was trained on, how, and what was kept.
struct Provenance {
  std::string entity;
  std::string code_version;
  uint64_t seed = 0;
  TrainingVariant variant = TrainingVariant::kRateAware;
  int64_t steps = 0;  ///< Steps of the optimiser, for autoencoder and dynamics together.
  double training_seconds = 0;
  double final_loss = 0;
  double psnr_db = 0;  ///< The target PSNR.
  /// Price at the end of training, in kilobytes per squared grey level; 0 if unknown.
  double error_price = 0;
  /// Bytes of the image latents of a snapshot that follows others, as estimated by the prior at the
  /// end of the autoencoder's training, smoothed; 0 if unknown. After that the prior is trained to
  /// predict instead.
  double prior_bytes = 0;
  /// Maximum error of numbers; 0 for exact numbers. Without a value, each number has a bound
  /// relative to its range of motion.
  std::optional<double> number_bound;
  int64_t snapshots = 0;  ///< Snapshots that the autoencoder was trained on.
  /// Version of the model whose weights training started from; 0 for none.
  int64_t started_from = 0;
  /// Snapshots of the entity, and of one that conditions it, that had been forgotten when the first
  /// of the models that it started from was trained; -1 in files that do not tell. If more are
  /// forgotten now, it may have learned from them.
  int64_t forgotten = -1;
  /// Recordings that the autoencoder was trained on, including those of the model that it started
  /// from.
  std::vector<TimeSpan> autoencoder_spans;
  /// The parts of them that the dynamics were trained on.
  std::vector<TimeSpan> dynamics_spans;
  /// The course of training; empty in files from before it was kept.
  std::vector<CurvePoint> curve;

  StoredForms forms;
  ModelChoice choice;

  friend bool operator==(const Provenance&, const Provenance&) = default;
};

}  // namespace engram::encoders
