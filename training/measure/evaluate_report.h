// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include "ltm/memory/memory_id.h"
#include "training/measure/prediction_quality.h"

namespace engram::training {

/// A prediction some snapshots ahead beside a copy of the last one, on the same snapshots.
struct PredictionQuality {
  int horizon = 0;  ///< Snapshots ahead.
  Quality model;
  Quality copy_last;
  BoundCoverage model_bound_coverage = {};
  BoundCoverage copy_bound_coverage = {};
  /// Of those moments alone when something moved as the prediction was made, where predictions tell
  /// (MemberPrediction::is_moving): things at rest hide what an engine is worth. Else empty.
  Quality moving = {};
  Quality moving_copy = {};
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

/// NaN becomes null.
[[nodiscard]] nlohmann::ordered_json to_json(const EvalReport& report);
[[nodiscard]] nlohmann::ordered_json to_json(const PredictionQuality& prediction);

}  // namespace engram::training
