// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "encoders/deep_model.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Consecutive values of one recording as rows, on the background of a scene that the model knows
/// or on one of their own, the median of their images: whichever costs less in bytes and, at the
/// model's last price, in error. A recording that the model was not trained on, seen from
/// elsewhere, has little to do with any scene. `pause` is called before each view that is tried.
/// Errors: kInvalidArgument where a value has another layout; those of the video codec and of
/// `pause`. Source: docs/learning.md, section "The image autoencoder".
Result<encoders::LatentRows> rows_on_best_view(encoders::DeepModel& model,
                                               std::span<const idf::SplitValue> values,
                                               const std::function<Status()>& pause = {});

}  // namespace engram::training
