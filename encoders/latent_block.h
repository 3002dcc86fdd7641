// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "encoders/coding/latent_sequence.h"
#include "encoders/coding/number_codec.h"

namespace engram::encoders {

/// What the images and numbers of consecutive snapshots are decoded from.
struct LatentRows {
  uint32_t scene = 0;                         ///< Which background.
  std::vector<std::vector<int32_t>> images;  ///< Per image member [rows, latents].
  std::vector<double> numbers;               ///< [rows, N].
};

/// Codes rows as one block, which decodes alone.
///
/// Format: the scene and the size of each image member's code as varints, those codes, the code of
/// the numbers, and a checksum of 32 bits over all, which also covers the number of rows.
/// Threading: const-parallel.
struct LatentBlockCodec {
  std::vector<LatentSequenceCodec> images;
  std::optional<NumberCodec> numbers;
  uint32_t scenes = 1;

  /// `rows` hold `count` rows of every member (checked).
  [[nodiscard]] std::vector<std::byte> encode(const LatentRows& rows, size_t count) const;

  /// The first `wanted` of the `count` rows of a block. Safe on hostile bytes.
  /// Errors: kDataLoss.
  Result<LatentRows> decode(std::span<const std::byte> block, size_t count, size_t wanted) const;
};

}  // namespace engram::encoders
