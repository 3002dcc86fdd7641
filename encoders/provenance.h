// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "encoders/training_curve.h"
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
  int64_t noise_images = 0;    ///< Whose noise the bound follows from; 0: it was given.
  double noise = 0;            ///< Their standard deviation. Unit: grey levels.
  int64_t rows = 0;
  // What was kept, each row once.
  int64_t latent_rows = 0;    ///< As latents, as the encoder made them.
  int64_t refined_rows = 0;   ///< As latents that were searched for.
  int64_t residual_rows = 0;  ///< As latents, refined or not, with a residual.
  int64_t video_rows = 0;
  int64_t lossless_rows = 0;
  int64_t kept_bytes = 0;
  // Of these, by form. A block's latents count evenly for its rows.
  int64_t latent_kept_bytes = 0;
  int64_t refined_kept_bytes = 0;
  int64_t residual_kept_bytes = 0;
  int64_t video_kept_bytes = 0;
  int64_t lossless_kept_bytes = 0;
  // What was tried, and what all rows would take in one form alone; 0: not tried.
  int64_t below_bound_rows = 0;   ///< Whose latents, as the encoder made them, miss the bound.
  int64_t refine_tried_rows = 0;  ///< Whose latents were searched for.
  int64_t latent_bytes = 0;       ///< As the encoder made them, whatever their error.
  int64_t residual_bytes = 0;     ///< As latents with residuals; 0 where some cannot be.
  int64_t video_bytes = 0;        ///< At the bound, or without loss where that is less.
  int64_t lossless_bytes = 0;

  friend bool operator==(const StoredForms&, const StoredForms&) = default;
};

/// Bytes that a store takes for an entity if it goes on with one model.
struct ModelBytes {
  int64_t known = 0;  ///< Latents of snapshots that had some before.
  int64_t news = 0;   ///< Of those that had none, numbers and remainders included.
  int64_t model = 0;  ///< Of the model's file, where the store would not have it otherwise.

  /// In so many nights that bring as much as this one.
  [[nodiscard]] double total(int64_t nights) const {
    return static_cast<double>(known) + static_cast<double>(news) * static_cast<double>(nights) +
           static_cast<double>(model);
  }
  friend bool operator==(const ModelBytes&, const ModelBytes&) = default;
};

/// A new model beside the one before it, on the same snapshots and at the same bound.
struct ModelChoice {
  int64_t previous_version = 0;  ///< 0: there was none to compare with.
  int64_t snapshots = 0;
  int64_t new_snapshots = 0;  ///< Of these, the ones that had no latents.
  int64_t nights = 1;
  ModelBytes previous;
  ModelBytes made;

  /// What a new model has to save at least, relative to going on with the one before it: encoders
  /// of video do not always give equal bytes for equal images.
  static constexpr double kMinGain = 0.005;

  /// Whether the new model is not worth its bytes.
  [[nodiscard]] bool keeps_previous() const {
    return previous_version > 0 && previous.total(nights) * (1 - kMinGain) <= made.total(nights);
  }
  friend bool operator==(const ModelChoice&, const ModelChoice&) = default;
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
  double psnr_db = 0;      ///< That was aimed at.
  double error_price = 0;  ///< Kilobytes of a squared grey level at the end; 0: unknown.
  /// What the prior told at the end of the autoencoder's training that the images' latents of a
  /// snapshot take after others, smoothed; 0: unknown. Later it is trained to predict instead.
  double prior_bytes = 0;
  /// Largest error of numbers; 0: none; not given: one of each, relative to how far it moves.
  std::optional<double> number_bound;
  int64_t snapshots = 0;     ///< That the autoencoder was trained on.
  int64_t started_from = 0;  ///< Version of the model whose weights were the first; 0: of none.
  /// Recordings that the autoencoder was trained on; those of the model that it started from, too.
  std::vector<TimeSpan> autoencoder_spans;
  /// The parts of them that the dynamics were trained on.
  std::vector<TimeSpan> dynamics_spans;
  std::vector<CurvePoint> curve;  ///< How it went; empty: of a file from before it was kept.

  StoredForms forms;
  ModelChoice choice;

  friend bool operator==(const Provenance&, const Provenance&) = default;
};

}  // namespace engram::encoders
