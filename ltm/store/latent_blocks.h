// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: finds the latents of a part that share their bytes.

#include <vector>

#include "ltm/store/latent.h"

namespace engram::ltm {

/// Max distance between consecutive rows of one block. Rows of other instances of the same
/// snapshots may lie between them. Source: docs/format.md, section "Latent segments".
inline constexpr uint64_t kMaxBlockStride = 64;

/// Finds the rows of a part that are in one block: their codes are the same bytes and their places
/// increase.
class LatentBlocks {
 public:
  /// Adds the next row and returns the first row of its block, which is an earlier row or the added
  /// row itself.
  /// Errors: kInvalidArgument if the latent's place is not valid in a block.
  /// Complexity: O(1), plus a comparison with each other block that is still open.
  Result<uint64_t> add(const Latent& latent);

 private:
  struct Open {
    Buffer code;
    uint64_t first_row = 0;
    uint64_t last_row = 0;
    GroupPlace last_place;
  };

  std::vector<Open> open_;  ///< Blocks to which later rows can still belong.
  uint64_t rows_ = 0;
};

}  // namespace engram::ltm
