// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "ltm/idf/layout.h"
#include "training/fit/train_options.h"

namespace engram::training {

/// Max size of networks as a share of the bytes that they may save.
inline constexpr double kMaxModelShare = 0.2;

/// Approximate size in bytes of networks with options.width, which must not be 0. The result is 0
/// if the layout has no images or cannot be a tensor.
[[nodiscard]] uint64_t network_bytes(const idf::Layout& layout, const TrainOptions& options);

/// Number of features of the networks for `snapshots` snapshots.
[[nodiscard]] int network_width(const TrainOptions& options, size_t snapshots);

/// The max number of features out of 32, 48, 64, 96 and 128 whose networks take no more than a
/// fifth of the bytes that they may save; 0 if there is none, or the layout has no images.
/// Source: docs/learning_methods.md, section "What is stored".
[[nodiscard]] int width_that_pays(const idf::Layout& layout, const TrainOptions& options,
                                  double saved_bytes);

}  // namespace engram::training
