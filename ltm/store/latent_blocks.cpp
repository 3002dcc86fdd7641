// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/latent_blocks.h"

#include <algorithm>
#include <map>

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

/// The remaining latents of one block.
using Block = std::vector<Latent*>;

Status recode_block(const MemoryId& entity, int version, const Block& block,
                    const LatentRecoder& recode) {
  std::vector<Latent> kept;
  for (const Latent* latent : block) kept.push_back(*latent);
  ENGRAM_ASSIGN_OR_RETURN(auto made, recode(entity, version, kept));
  if (made.size() != kept.size())
    return invalid_argument("entity '{}': a recoder made {} latents of v{}, needs {}",
                            entity.to_string(), made.size(), version, kept.size());
  for (size_t i = 0; i < block.size(); ++i) {
    block[i]->code = std::move(made[i].code);
    block[i]->place = made[i].place;
  }
  return {};
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

Status recode_cut_blocks(const MemoryId& entity, std::vector<LatentSnapshot>& snapshots,
                         const LatentRecoder& recode) {
  LatentBlocks blocks;
  std::map<uint64_t, Block> rows_of;
  for (LatentSnapshot& snapshot : snapshots) {
    for (LatentInstance& instance : snapshot.instances) {
      ENGRAM_ASSIGN_OR_RETURN(const uint64_t first, blocks.add(instance.latent));
      if (instance.latent.place.count > 1) rows_of[first].push_back(&instance.latent);
    }
  }
  for (const auto& [first, block] : rows_of)
    if (block.size() < block.front()->place.count)
      ENGRAM_RETURN_IF_ERROR(recode_block(entity, snapshots.front().model_version, block, recode));
  return {};
}

}  // namespace engram::ltm
