// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "encoders/deep_model.h"
#include "training/representation.h"
#include "training/video_search.h"

// Internal to the room: includes LibTorch.

namespace engram::training {

/// Codes runs of snapshots as blocks, each image member in the form that takes fewest bytes and
/// keeps the bound.
///
/// Threading: one thread.
class BlockChoice {
 public:
  /// The model outlives it.
  BlockChoice(encoders::DeepModel& model, const RepresentationOptions& options);

  /// One latent per value: consecutive values of one recording, at most a block.
  /// Errors: kCancelled on `stop`; kInvalidArgument.
  Result<std::vector<ltm::Latent>> encode(std::span<const idf::Data> values,
                                          const std::stop_token& stop = {});

  [[nodiscard]] const encoders::StoredForms& counts() const { return counts_; }

 private:
  Status choose(size_t image, std::span<const idf::NdArray> images, encoders::ImageRows& rows,
                bool is_within);
  /// Per image member whether the latents keep the bound in every row.
  Result<std::vector<bool>> within_bound(const encoders::LatentRows& rows,
                                         std::span<const idf::SplitValue> values);

  encoders::DeepModel& model_;
  RepresentationOptions options_;
  std::vector<VideoSearch> searches_;  ///< Per image member.
  encoders::StoredForms counts_;
};

}  // namespace engram::training
