// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "ltm/core/progress.h"
#include "ltm/memory/memory_id.h"
#include "training/evaluate.h"
#include "training/trainer.h"

namespace engram::training {

struct CrossvalOptions {
  /// How each model is trained; its budget is that of one fold.
  TrainOptions train;
  /// A query without selectors that matches one entity.
  std::string entity;
  /// Steps of refining the latents that are measured (latent_refinement.h).
  int refine_steps = 0;
  /// Folds that are made, from the first on; nothing: one per recording.
  std::optional<size_t> most_folds;

  [[nodiscard]] Status validate() const;
};

/// Ways to predict, on the same snapshots.
enum class Predicting { kModel, kCopyLast, kLinear };
inline constexpr size_t kPredictings = 3;

/// "model", "copy-last", "linear".
[[nodiscard]] std::string_view to_string(Predicting predicting);

/// What a model is worth on data that it was and was not trained on.
struct CrossvalFold {
  Time first{};              ///< Of the recording that was left out; not set in the mean.
  uint64_t snapshots = 0;    ///< Of it.
  Quality trained;           ///< Reconstruction of the recordings that it was trained on.
  Quality left_out;          ///< Of the one that was left out.
  double trained_bytes = 0;  ///< Of a snapshot's latents, in blocks.
  double left_out_bytes = 0;
  uint64_t model_bytes = 0;
  /// Predictions of the left-out recording, by Predicting, one and two snapshots ahead.
  std::array<std::array<Quality, 2>, kPredictings> prediction;
};

struct CrossvalReport {
  ltm::MemoryId entity;
  std::vector<CrossvalFold> folds;
  CrossvalFold all;  ///< Over the snapshots of all folds; bytes are means of the folds.
};

/// Trains a model on all recordings of an entity but one, for each of them, and measures it on the
/// one that was left out. Nothing is published.
/// Errors: kInvalidArgument where there are fewer than two recordings; kNotFound; kCancelled; those
/// of the store and of training.
/// Threading: one at a time per process (train_model).
Result<CrossvalReport> crossval(const std::filesystem::path& store, const CrossvalOptions& options,
                                const ProgressSink& progress = {},
                                const std::stop_token& stop = {});

/// NaN becomes null.
[[nodiscard]] nlohmann::ordered_json to_json(const CrossvalReport& report);

}  // namespace engram::training
