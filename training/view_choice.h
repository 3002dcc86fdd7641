// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "encoders/deep_model.h"

// Internal to the room: includes LibTorch.

namespace engram::training {

/// Consecutive values of one recording as rows, on the background of a scene that the model knows
/// or on one of their own, the median of their images: whichever costs less in bytes and, at the
/// model's last price, in error. A recording that the model was not trained on, seen from
/// elsewhere, has little to do with any scene. Errors: kInvalidArgument where a value has another
/// layout; those of the video codec. Source: docs/learning.md, section "The image autoencoder".
Result<encoders::LatentRows> rows_on_best_view(encoders::DeepModel& model,
                                               std::span<const idf::SplitValue> values);

}  // namespace engram::training
