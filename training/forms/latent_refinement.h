// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <stop_token>

#include "encoders/deep_model.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Options of the refinement of the latents of a block.
struct RefineOptions {
  /// Steps of the optimiser for a block; 0 to keep the latents from the encoder.
  int steps = 0;
  /// Min PSNR that every image should reach; 0 for the model's own balance of error and bytes.
  double bound_db = 0;
};

/// Improves the latents of one block of consecutive values of one recording by gradient descent
/// with frozen networks. This gives fewer bytes and less error than the encoder's latents, in
/// particular on recordings that the model was not trained on.
///
/// The result is kept only if it costs less in real bytes and decoded error; with a bound, the
/// number of rows that reach it counts first. `rows` must be those of DeepModel::to_rows(values).
/// Without latents the function does nothing.
/// Errors: kCancelled; kInvalidArgument if a value has another layout.
/// Threading: one thread.
/// Source: docs/learning_methods.md, section "Latents refined".
Result<encoders::LatentRows> refine_latents(encoders::DeepModel& model,
                                            std::span<const idf::SplitValue> values,
                                            encoders::LatentRows rows, const RefineOptions& options,
                                            const std::stop_token& stop);

}  // namespace engram::training
