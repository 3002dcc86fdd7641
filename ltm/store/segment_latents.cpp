// SPDX-License-Identifier: Apache-2.0
#include "ltm/store/segment_latents.h"

#include <algorithm>

namespace engram::ltm {

namespace {

/// Max number of blocks kept per part. The instances of one snapshot may be in different blocks, so
/// one is not enough.
constexpr size_t kKeptBlocks = 4;

}  // namespace

Status LatentCodeColumn::append(const Latent& latent) {
  const uint64_t row = holders_.size();
  ENGRAM_ASSIGN_OR_RETURN(const uint64_t holder, blocks_.add(latent));
  blobs_.append(holder == row ? latent.code.bytes() : std::span<const std::byte>());
  holders_.push_back(holder);
  indices_.push_back(latent.place.index);
  counts_.push_back(latent.place.count);
  return {};
}

Status LatentCodeColumn::write(h5::File& file, const std::string& group) const {
  ENGRAM_RETURN_IF_ERROR(blobs_.write(file, group));
  // Without these columns every row is alone, so segments without blocks do not store them.
  if (std::ranges::all_of(counts_, [](uint32_t count) { return count == 1; })) return {};
  ENGRAM_RETURN_IF_ERROR(write_row_column(file, group + "/holder", holders_));
  ENGRAM_RETURN_IF_ERROR(write_row_column(file, group + "/index", indices_));
  return write_row_column(file, group + "/count", counts_);
}

Result<Latent> LatentCodeReader::read(const std::string& group, uint64_t row) {
  Latent latent;
  ENGRAM_ASSIGN_OR_RETURN(const SegmentColumn* holders, source_.column_if_there(group + "/holder"));
  if (holders == nullptr) {
    ENGRAM_ASSIGN_OR_RETURN(latent.code, source_.blob(group, row));
    return latent;
  }
  ENGRAM_ASSIGN_OR_RETURN(const Spot found, spot(group, row));
  latent.place = found.place;
  if (found.place.count == 1) {
    ENGRAM_ASSIGN_OR_RETURN(latent.code, source_.blob(group, row));
    return latent;
  }
  ENGRAM_RETURN_IF_ERROR(check_block(group, row, found));
  ENGRAM_ASSIGN_OR_RETURN(latent.code, block(group, found.holder));
  return latent;
}

Result<LatentCodeReader::Spot> LatentCodeReader::spot(const std::string& group, uint64_t row) {
  Spot found;
  ENGRAM_ASSIGN_OR_RETURN(found.holder, source_.row_number<uint64_t>(group + "/holder", row));
  ENGRAM_ASSIGN_OR_RETURN(found.place.index, source_.row_number<uint32_t>(group + "/index", row));
  ENGRAM_ASSIGN_OR_RETURN(found.place.count, source_.row_number<uint32_t>(group + "/count", row));
  const GroupPlace& place = found.place;
  if (place.index >= place.count || place.count > kMaxGroupImages)
    return source_.broken(group, fmt::format("row {} has place {} of {}, needs one of at most {}",
                                             row, place.index, place.count, kMaxGroupImages));
  if (found.holder > row || (place.count == 1 && found.holder != row))
    return source_.broken(group, fmt::format("row {}, place {} of {}, is held by row {}", row,
                                             place.index, place.count, found.holder));
  return found;
}

/// Fails if a row contradicts its block. Complexity: O(kMaxBlockStride).
Status LatentCodeReader::check_block(const std::string& group, uint64_t row, const Spot& found) {
  if (found.holder == row) return {};
  ENGRAM_ASSIGN_OR_RETURN(const Spot first, spot(group, found.holder));
  if (first.holder != found.holder)
    return source_.broken(group, fmt::format("row {} is held by row {}, which is held by row {}",
                                             row, found.holder, first.holder));
  return check_before(group, row, found);
}

/// Fails if the previous row of the same block does not come before this row in the block.
Status LatentCodeReader::check_before(const std::string& group, uint64_t row, const Spot& found) {
  const uint64_t min = std::max(found.holder, row - std::min(row, kMaxBlockStride));
  for (uint64_t before = row; before-- > min;) {
    ENGRAM_ASSIGN_OR_RETURN(const Spot last, spot(group, before));
    if (last.holder != found.holder) continue;
    if (last.place.count == found.place.count && last.place.index < found.place.index) return {};
    return source_.broken(
        group,
        fmt::format("row {} has place {} of {} behind place {} of {} of the same block", row,
                    found.place.index, found.place.count, last.place.index, last.place.count));
  }
  return source_.broken(group, fmt::format("row {} needs a row of its block among the {} before it",
                                           row, kMaxBlockStride));
}

Result<Buffer> LatentCodeReader::block(const std::string& group, uint64_t holder) {
  std::vector<Block>& kept = blocks_[group];
  const auto known = std::ranges::find(kept, holder, &Block::holder);
  if (known != kept.end()) return known->code;
  ENGRAM_ASSIGN_OR_RETURN(Buffer code, source_.blob(group, holder));
  if (code.empty())
    return source_.broken(group, fmt::format("row {} holds a block, but no bytes", holder));
  if (kept.size() == kKeptBlocks) kept.erase(kept.begin());
  kept.push_back({holder, code});
  return code;
}

}  // namespace engram::ltm
