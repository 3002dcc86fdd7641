// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "ltm/core/time.h"

namespace engram::encoders {

/// Both ends included.
struct TimeSpan {
  Time first{};
  Time last{};

  [[nodiscard]] bool contains(Time time) const { return first <= time && time <= last; }
  friend bool operator==(const TimeSpan&, const TimeSpan&) = default;
};

/// Where a model comes from.
struct Provenance {
  std::string entity;
  std::string code_version;
  uint64_t seed = 0;
  int64_t steps = 0;  ///< Of the optimiser, autoencoder and dynamics together.
  double training_seconds = 0;
  double final_loss = 0;
  double psnr_db = 0;       ///< That was aimed at.
  double number_bound = 0;  ///< Of numbers; 0: one of each, relative to how far it moves.
  int64_t snapshots = 0;  ///< That the autoencoder was trained on.
  /// Recordings that the autoencoder was trained on.
  std::vector<TimeSpan> autoencoder_spans;
  /// The parts of them that the dynamics were trained on.
  std::vector<TimeSpan> dynamics_spans;

  friend bool operator==(const Provenance&, const Provenance&) = default;
};

}  // namespace engram::encoders
