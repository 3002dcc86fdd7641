// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "encoders/latent_chain.h"
#include "ltm/codec/packed_value.h"

namespace engram::encoders {

/// Chains of a block. What they share, a background of their own, is then cheap.
inline constexpr size_t kMaxChains = 8;
/// Most rows of a block.
inline constexpr size_t kMaxBlockRows = ltm::kMaxGroupImages;

/// A block whose checksum fits, and what its chains share. Lives as long as the bytes.
struct OpenBlock {
  size_t count = 0;       ///< Rows.
  size_t chain_rows = 0;  ///< Of every chain but the last, which may have fewer.
  uint32_t scene = 0;
  std::vector<CodedBackground> own;  ///< Decoded; per image member, or none.
  std::vector<std::span<const std::byte>> chains;

  /// Rows of a chain.
  [[nodiscard]] size_t rows_of(size_t chain) const {
    return std::min(chain_rows, count - chain * chain_rows);
  }
};

/// What a block says of itself, without its model.
struct BlockDescription {
  size_t chain_rows = 0;
  std::vector<uint64_t> background_bytes;      ///< Per image member; 0: it has none of its own.
  std::vector<std::vector<ImageCode>> chains;  ///< [chain][image member].
};

/// Errors: kDataLoss.
Result<BlockDescription> describe_block(std::span<const std::byte> block, size_t count,
                                        size_t images);

/// Rows of a block as rows of its chains.
[[nodiscard]] std::vector<LatentRows> cut_chains(const LatentRows& rows, size_t count,
                                                 size_t chain_rows);

/// Codes consecutive rows as one block: chains that decode alone, seen from one view.
///
/// Format: as varints, twice the scene, plus one where the block has backgrounds of its own; form
/// and size of those; rows of a chain; the size of each chain; then backgrounds, chains, and a
/// checksum of 32 bits over all, which also covers the number of rows.
/// Threading: const-parallel.
struct LatentBlockCodec {
  LatentChainCodec chain;
  uint32_t scenes = 1;
  size_t chain_rows = 16;

  /// `chains` are those of `count` rows, of one scene and background (checked).
  [[nodiscard]] std::vector<std::byte> encode(std::span<const LatentRows> chains,
                                              size_t count) const;

  /// Safe on hostile bytes.
  /// Errors: kDataLoss; kFailedPrecondition where a background's decoder is not installed.
  Result<OpenBlock> open(std::span<const std::byte> block, size_t count) const;

  /// The first `wanted` rows of a chain. Errors: those of LatentChainCodec::decode.
  Result<LatentRows> decode(const OpenBlock& block, size_t chain_index, size_t wanted) const;

  /// All rows of all chains, one after another. Errors: those of open and decode.
  Result<std::vector<LatentRows>> decode_all(std::span<const std::byte> block, size_t count) const;
};

}  // namespace engram::encoders
