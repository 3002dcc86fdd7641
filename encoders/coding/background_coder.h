// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "encoders/coding/latent_grid.h"
#include "ltm/core/status.h"

namespace engram::encoders {

/// The value that the checksum of backgrounds covers beside their bytes.
[[nodiscard]] uint64_t scenes_identity(size_t scenes, const LatentGrid& shape);

/// Codes the whole grey levels of backgrounds without loss: each is predicted from its left, upper
/// and upper left neighbours (median edge detector) and, if that takes fewer bytes, also from the
/// residual of the previous channel at the same place.
///
/// It uses integer arithmetic only. The code ends in a checksum of 32 bits, which also covers
/// `shape`.
/// Shape: [scenes, channels, height, width]; `shape` is that of one scene.
/// Source: Weinberger, Seroussi and Sapiro, "The LOCO-I Lossless Image Compression Algorithm",
/// 2000.
[[nodiscard]] std::vector<std::byte> encode_backgrounds(std::span<const uint8_t> pixels,
                                                        const LatentGrid& shape);

/// Decodes backgrounds. It is safe on hostile bytes. `what` names the backgrounds in messages.
/// Errors: kDataLoss if the checksum does not fit.
Result<std::vector<uint8_t>> decode_backgrounds(std::span<const std::byte> bytes, size_t scenes,
                                                const LatentGrid& shape, std::string_view what);

}  // namespace engram::encoders
