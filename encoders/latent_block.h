// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "encoders/latent_chain.h"
#include "ltm/codec/packed_value.h"

namespace engram::encoders {

/// Maximum number of chains in a block. They share the cost of the background that the block
/// carries.
inline constexpr size_t kMaxChains = 8;
/// Maximum number of rows in a block.
inline constexpr size_t kMaxBlockRows = ltm::kMaxGroupImages;

/// A block whose checksum was verified. It refers to the bytes of the block, which must outlive it.
struct OpenBlock {
  size_t count = 0;       ///< Rows.
  size_t chain_rows = 0;  ///< Of every chain but the last one, which may have fewer.
  uint32_t scene = 0;
  std::vector<CodedBackground> own;  ///< Decoded backgrounds per image member, or empty.
  std::vector<std::span<const std::byte>> chains;

  /// Number of rows in a chain.
  [[nodiscard]] size_t rows_of(size_t chain) const {
    return std::min(chain_rows, count - chain * chain_rows);
  }
};

/// The head of a block, which can be read without its model.
struct BlockDescription {
  size_t chain_rows = 0;
  /// Per image member; 0 if the block carries no background.
  std::vector<uint64_t> background_bytes;
  std::vector<std::vector<ImageCode>> chains;  ///< [chain][image member].
};

/// Errors: kDataLoss.
Result<BlockDescription> describe_block(std::span<const std::byte> block, size_t count,
                                        size_t images);

/// Splits the rows of a block into the rows of its chains.
[[nodiscard]] std::vector<LatentRows> cut_chains(const LatentRows& rows, size_t count,
                                                 size_t chain_rows);

/// Codes consecutive rows of one view as one block of chains. Each chain decodes without the
/// others.
///
/// Format: varints for twice the scene (plus one if the block carries backgrounds), the form and
/// size of each such background, the number of rows of a chain and the size of each chain; then the
/// backgrounds, the chains, and a checksum of 32 bits over all bytes and the number of rows.
/// Threading: const-parallel.
struct LatentBlockCodec {
  LatentChainCodec chain;
  uint32_t scenes = 1;
  size_t chain_rows = 16;

  /// Encodes `chains` of together `count` rows, which have one scene and background (checked).
  [[nodiscard]] std::vector<std::byte> encode(std::span<const LatentRows> chains,
                                              size_t count) const;

  /// Verifies the checksum and reads the head. It is safe on hostile bytes.
  /// Errors: kDataLoss; kFailedPrecondition if the decoder of a background is not installed.
  Result<OpenBlock> open(std::span<const std::byte> block, size_t count) const;

  /// Decodes the first `wanted` rows of a chain.
  /// Errors: the errors of LatentChainCodec::decode.
  Result<LatentRows> decode(const OpenBlock& block, size_t chain_index, size_t wanted) const;

  /// Decodes all rows of all chains, in their order.
  /// Errors: the errors of open and decode.
  Result<std::vector<LatentRows>> decode_all(std::span<const std::byte> block, size_t count) const;
};

}  // namespace engram::encoders
