// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>

#include "training/fit/dataset.h"

// Internal to the learning rooms: includes LibTorch.

namespace engram::training {

/// Finds the backgrounds of a dataset with images, whose `scene` is zero: the median image of each
/// recording. Recordings with similar medians share one. The backgrounds of `start`, which may be
/// null, come first and unchanged, and recordings that it knows share them. The function sets
/// `scene`, `backgrounds`, `coded_backgrounds` and `known_scenes`.
/// Errors: kCancelled.
Status find_scenes(Dataset& data, const encoders::DeepModel* start, const std::stop_token& stop);

/// The background that the median image of a sequence is nearest to. The dataset must have some.
[[nodiscard]] int64_t nearest_scene(const Dataset& data, const Sequence& sequence);

}  // namespace engram::training
