// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "encoders/deep_model.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Encodes consecutive values of one recording as rows, either on the background of a known scene
/// or on a background of their own, the median of their images. It chooses the lower cost in bytes
/// and, at the model's last price, in error. A new recording from another viewpoint matches none of
/// the known scenes. `pause` is called before each tried view.
/// Errors: kInvalidArgument if a value has another layout; the errors of the video codec and of
/// `pause`.
/// Source: docs/learning_methods.md, section "The image autoencoder".
Result<encoders::LatentRows> rows_on_best_view(encoders::DeepModel& model,
                                               std::span<const idf::SplitValue> values,
                                               const std::function<Status()>& pause = {});

}  // namespace engram::training
