// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <stop_token>

#include "encoders/deep_model.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// How the latents of a block are searched for.
struct RefineOptions {
  /// Steps of the optimiser for a block; 0: latents stay as the encoder made them.
  int steps = 0;
  /// Least PSNR that every image should reach; 0: the model's own balance of error and bytes.
  double bound_db = 0;
};

/// Improves the latents of one block of consecutive values of one recording by gradient descent,
/// networks frozen: fewer bytes and less error than what the encoder guesses at once, most of all
/// on what the model was not trained on.
///
/// Kept is whichever costs less in real bytes and decoded error; with a bound, rows that reach it
/// come before those that do not. `rows` are those of DeepModel::to_rows(values). Does nothing
/// where there are no latents.
/// Errors: kCancelled; kInvalidArgument where a value has another layout.
/// Threading: one thread.
/// Source: docs/learning.md, section "Latents refined".
Result<encoders::LatentRows> refine_latents(encoders::DeepModel& model,
                                            std::span<const idf::SplitValue> values,
                                            encoders::LatentRows rows, const RefineOptions& options,
                                            const std::stop_token& stop);

}  // namespace engram::training
