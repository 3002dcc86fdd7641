// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: which latents of a part share their bytes.

#include <vector>

#include "ltm/store/latent.h"

namespace engram::ltm {

/// Rows of one block lie at most so far apart: other instances of their snapshots may lie between
/// them. Source: docs/format.md, section "Latent segments".
inline constexpr uint64_t kMaxBlockStride = 64;

/// Finds the rows of a part that are of one block: their codes are the same bytes, their places
/// increase.
class LatentBlocks {
 public:
  /// The row that stands first of the next row's block: an earlier one, or that row itself.
  /// Errors: kInvalidArgument where its place is none that a block can have.
  /// Complexity: O(1); where other blocks are still open, they are compared with.
  Result<uint64_t> add(const Latent& latent);

 private:
  struct Open {
    Buffer code;
    uint64_t first_row = 0;
    uint64_t last_row = 0;
    GroupPlace last_place;
  };

  std::vector<Open> open_;  ///< That later rows may be of.
  uint64_t rows_ = 0;
};

/// Has each block of an entity of which not all places are left coded anew from those that are.
///
/// `snapshots` are what stays of a part, in its order; they may share blocks with nothing else.
/// Errors: those of `recode`; kInvalidArgument where it gives another number of latents than it
/// got.
Status recode_cut_blocks(const MemoryId& entity, std::vector<LatentSnapshot>& snapshots,
                         const LatentRecoder& recode);

}  // namespace engram::ltm
