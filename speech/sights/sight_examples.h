// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stop_token>
#include <vector>

#include "speech/sights/learn_sights.h"
#include "speech/sights/sight_layers.h"
#include "speech/sights/true_sights.h"

// Private to this room: includes LibTorch.

namespace engram::speech {

/// N images with what they show.
struct SightBatch {
  torch::Tensor cells;    ///< [N, channels, R, C], half.
  torch::Tensor kinds;    ///< [N, R, C]; behind the last kind: nothing; kNotLearned: unclear.
  torch::Tensor where;    ///< [N, kinds]; kNotLearned: there is no such thing.
  torch::Tensor colours;  ///< [N, kinds]
  torch::Tensor sight;    ///< [N, kinds], bool: it is in sight.

  static constexpr int64_t kNotLearned = -100;

  [[nodiscard]] int64_t size() const { return cells.defined() ? cells.size(0) : 0; }
};

struct SightExamples {
  SightWords words;
  uint64_t model = 0;
  CellGrid grid;
  SightBatch learned;   ///< Changed copies are among them.
  SightBatch held_out;  ///< Of recordings that are left out.
  SightsReport report;  ///< Its counts of images are filled.
};

/// Errors: those of learn_sights.
Result<SightExamples> read_examples(const std::vector<std::filesystem::path>& stores,
                                    const LearnSightsOptions& options, const ProgressSink& progress,
                                    const std::stop_token& stop);

}  // namespace engram::speech
