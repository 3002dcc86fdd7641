// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/latent_blocks.h"

#include <algorithm>

namespace engram::ltm {

namespace {

Status check_place(const Latent& latent, uint64_t row) {
  const GroupPlace& place = latent.place;
  if (place.index >= place.count || place.count > kMaxGroupImages)
    return invalid_argument("latent of row {}: found place {} of {}, needs one of at most {}", row,
                            place.index, place.count, kMaxGroupImages);
  if (place.count > 1 && latent.code.empty())
    return invalid_argument("latent of row {}: is of a block of {}, which needs bytes", row,
                            place.count);
  return {};
}

bool is_same(const Buffer& a, const Buffer& b) {
  return a.size() == b.size() && (a.data() == b.data() || std::ranges::equal(a.bytes(), b.bytes()));
}

}  // namespace

Result<uint64_t> LatentBlocks::add(const Latent& latent) {
  const uint64_t row = rows_++;
  ENGRAM_RETURN_IF_ERROR(check_place(latent, row));
  if (latent.place.count == 1) return row;
  std::erase_if(open_, [row](const Open& block) { return row - block.last_row > kMaxBlockStride; });
  // Try the newest block first: if two blocks have the same bytes, the older one may have lost its
  // last rows.
  for (size_t i = open_.size(); i-- > 0;) {
    Open& block = open_[i];
    if (block.last_place.count != latent.place.count ||
        block.last_place.index >= latent.place.index || !is_same(block.code, latent.code))
      continue;
    block.last_row = row;
    block.last_place = latent.place;
    return block.first_row;
  }
  open_.push_back({latent.code, row, row, latent.place});
  return row;
}

}  // namespace engram::ltm
