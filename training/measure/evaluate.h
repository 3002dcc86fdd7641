// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/memory/memory_id.h"

namespace engram::training {

struct EvaluateOptions {
  /// Queries without selectors; empty: every entity with a model.
  std::vector<std::string> entities;
  /// Most predictions to measure per entity and horizon, evenly spaced. Each costs some 10 ms.
  size_t max_predictions = 2000;
};

/// Quality over many snapshots. NaN where there was nothing to measure.
struct Quality {
  uint64_t images = 0;        ///< Values with images.
  uint64_t capped = 0;        ///< Those whose PSNR was capped at 60 dB.
  double mean_psnr_db = 0;    ///< Mean of the values' PSNR.
  double pooled_psnr_db = 0;  ///< PSNR of the pooled squared error.
  double minimum_psnr_db = 0;
  double low_psnr_db = 0;  ///< 5 % of the values are below.
  uint64_t numbers = 0;    ///< Values with numbers.
  double rmse = 0;
  double mean_ssim = 0;  ///< Of images of 8 bits, where it was measured: in cross-validation.
};

/// Whether errors of one kind were what predictions had told beforehand. NaN where nothing was.
struct Coverage {
  uint64_t predictions = 0;  ///< That told a bound.
  uint64_t within = 0;       ///< Whose real error was at most that.
  /// Mean of the bounds. Unit: images dB, numbers that of a root mean square.
  double mean_bound = 0;
  double expected = 0;  ///< Mean of the squared errors that were expected, in the same unit.

  [[nodiscard]] double share() const;  ///< Of those within; NaN without any.
};

struct Foresight {
  Coverage images, numbers;
};

/// A prediction some snapshots ahead beside a copy of the last one, on the same snapshots.
struct PredictionQuality {
  int horizon = 0;  ///< Snapshots ahead.
  Quality model;
  Quality copy_last;
  Foresight model_foresight = {};
  Foresight copy_foresight = {};
};

/// What a model knew of the snapshots that it is measured on.
enum class Known {
  kTrained,           ///< Autoencoder and dynamics were trained on them.
  kHeldOut,           ///< The autoencoder was, the dynamics were not.
  kLeftOutRecording,  ///< Neither was.
};
inline constexpr size_t kKnownKinds = 3;

/// "trained on", "held out", "left-out recordings".
[[nodiscard]] std::string_view to_string(Known known);

/// Time to read and decode one snapshot from its latents, median over some hundred. NaN where there
/// are none. Unit: ms.
struct AccessTimes {
  double in_order_ms = 0;   ///< Each after the one before it.
  double scattered_ms = 0;  ///< Never two of one block one after the other.
};

/// What the latents of images take in blocks beside what probabilities say that they should. Sums
/// over blocks that hold nothing but latents.
struct CodeLength {
  uint64_t rows = 0;
  uint64_t later_rows = 0;  ///< Those with a row before them in their block.
  double coded_bytes = 0;   ///< Of real code, checksums included.
  double ideal_bytes = 0;   ///< -log2 of the probabilities that the coder gave.
  double later_bytes = 0;   ///< The same of later rows.
  /// Of one later row, as the prior told when the autoencoder was trained by it (Provenance); 0:
  /// unknown.
  double prior_row_bytes = 0;
};

/// How well the newest model of one entity remembers and predicts.
struct EntityEvaluation {
  ltm::MemoryId entity;
  int model_version = 0;
  uint64_t snapshots = 0;           ///< With latents of the newest model.
  uint64_t not_evaluated = 0;       ///< Of these, without recorded form: nothing to compare with.
  Quality reconstruction;           ///< Of the snapshots that the autoencoder was trained on.
  Quality left_out_reconstruction;  ///< Of left-out recordings.
  std::array<std::vector<PredictionQuality>, kKnownKinds> prediction;  ///< By Known.
  AccessTimes access;
  CodeLength code;
  uint64_t raw_bytes = 0;     ///< Plain bytes of the entity.
  uint64_t stored_bytes = 0;  ///< Online form.
  uint64_t latent_bytes = 0;
  uint64_t model_bytes = 0;
};

struct EvalReport {
  std::vector<EntityEvaluation> entities;  ///< In the order of their names; those with models.
};

/// Measures the models of a store against the recorded snapshots that it still holds.
///
/// Reconstructions are decoded from the stored latents. Predictions start from the last two
/// recorded snapshots, one and two ahead, and never cross a gap between recordings.
/// Errors: kInvalidArgument; kCancelled; those of the store and of loading models.
Result<EvalReport> evaluate(const std::filesystem::path& store, const EvaluateOptions& options,
                            const ProgressSink& progress = {}, const std::stop_token& stop = {});

/// NaN becomes null.
[[nodiscard]] nlohmann::ordered_json to_json(const EvalReport& report);
[[nodiscard]] nlohmann::ordered_json to_json(const PredictionQuality& prediction);

}  // namespace engram::training
