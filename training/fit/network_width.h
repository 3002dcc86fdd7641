// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "ltm/idf/layout.h"
#include "training/fit/train_options.h"

namespace engram::training {

/// Networks may take this part of what they save.
inline constexpr double kMaxModelShare = 0.2;

/// About the bytes of networks of options.width, which is not 0; 0 where the layout has no images
/// or cannot be a tensor.
[[nodiscard]] uint64_t network_bytes(const idf::Layout& layout, const TrainOptions& options);

/// Features of the networks that are made for so many snapshots.
[[nodiscard]] int network_width(const TrainOptions& options, size_t snapshots);

/// The most features of 32, 48, 64, 96 and 128 whose networks take no more than a fifth of the
/// bytes that they may save; 0 where none do, or the layout has no images.
/// Source: docs/learning.md, section "What is stored: latents or video".
[[nodiscard]] int width_that_pays(const idf::Layout& layout, const TrainOptions& options,
                                  double saved_bytes);

}  // namespace engram::training
