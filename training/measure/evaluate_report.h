// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include "ltm/memory/memory_id.h"
#include "training/measure/prediction_quality.h"

namespace engram::training {

/// The quality of predictions of one horizon, and that of copies of the last snapshot on the same
/// snapshots.
struct PredictionQuality {
  int horizon = 0;  ///< Snapshots ahead.
  Quality model;
  Quality copy_last;
  BoundCoverage model_bound_coverage = {};
  BoundCoverage copy_bound_coverage = {};
  /// The same over those moments alone in which something moved when the prediction was made.
  /// Things at rest hide the differences between engines. Empty if predictions do not say it
  /// (MemberPrediction::is_moving).
  Quality moving = {};
  Quality moving_copy = {};
};

/// Whether a model was trained on the snapshots that it is measured on.
enum class Known {
  kTrained,           ///< Autoencoder and dynamics were trained on them.
  kHeldOut,           ///< The autoencoder was trained on them, the dynamics were not.
  kLeftOutRecording,  ///< Neither was trained on them.
};
inline constexpr size_t kKnownKinds = 3;

/// "trained on", "held out", "left-out recordings".
[[nodiscard]] std::string_view to_string(Known known);

/// Time to read and decode one snapshot from its latents, measured over some hundred. NaN without
/// latents. Unit: ms.
struct AccessTimes {
  /// The mean of snapshots read in order: a chain is decoded once, when its first one is read.
  double in_order_ms = std::numeric_limits<double>::quiet_NaN();
  /// The median, and what 99 % need, of snapshots read such that consecutive ones are of different
  /// blocks.
  double scattered_ms = std::numeric_limits<double>::quiet_NaN();
  double scattered_p99_ms = std::numeric_limits<double>::quiet_NaN();
};

/// Size of image latents in blocks and their ideal code length. Sums over blocks that hold only
/// latents.
struct CodeLength {
  uint64_t rows = 0;
  uint64_t later_rows = 0;  ///< Rows with a row before them in their block.
  double coded_bytes = 0;   ///< Size of the real code, including checksums.
  double ideal_bytes = 0;   ///< Ideal length: -log2 of the coder's probabilities.
  double later_bytes = 0;   ///< Ideal length of later rows.
  /// Size of one later row as estimated by the prior when the autoencoder was trained (Provenance);
  /// 0 if unknown.
  double prior_row_bytes = 0;
};

/// The quality of reconstruction and prediction of the newest model of one entity.
struct EntityEvaluation {
  ltm::MemoryId entity;
  int model_version = 0;
  uint64_t snapshots = 0;           ///< Snapshots with latents of the newest model.
  uint64_t not_evaluated = 0;       ///< Those of them without a recorded form to compare with.
  Quality reconstruction;           ///< Snapshots that the autoencoder was trained on.
  Quality left_out_reconstruction;  ///< Snapshots of left-out recordings.
  std::array<std::vector<PredictionQuality>, kKnownKinds> prediction;  ///< By Known.
  AccessTimes access;
  CodeLength code;
  uint64_t raw_bytes = 0;     ///< Plain bytes of the entity.
  uint64_t stored_bytes = 0;  ///< Size of the recorded form.
  uint64_t latent_bytes = 0;
  uint64_t model_bytes = 0;
};

struct EvalReport {
  std::vector<EntityEvaluation> entities;  ///< Entities with models, sorted by name.
};

/// Conversions to JSON. NaN becomes null.
[[nodiscard]] nlohmann::ordered_json to_json(const EvalReport& report);
[[nodiscard]] nlohmann::ordered_json to_json(const PredictionQuality& prediction);

}  // namespace engram::training
