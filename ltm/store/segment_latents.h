// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the codes of latents in segment files.

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ltm/store/latent_blocks.h"
#include "ltm/store/segment_blobs.h"
#include "ltm/store/segment_source.h"

namespace engram::ltm {

/// A column with the codes of latents, one per row. The code of a block is stored once, at its
/// first row.
///
/// Source: docs/format.md, section "Latent segments".
class LatentCodeColumn {
 public:
  /// Errors: those of LatentBlocks::add.
  Status append(const Latent& latent);

  /// Errors: those of h5::File::write.
  Status write(h5::File& file, const std::string& group) const;

 private:
  LatentBlocks blocks_;
  BlobColumn blobs_;
  std::vector<uint64_t> holders_;
  std::vector<uint32_t> indices_, counts_;
};

/// Reads the codes of latents. Rows of one block share its bytes. The last few blocks of each part
/// are kept.
///
/// Errors: all functions return kDataLoss naming file, object and row.
/// Threading: one thread. The source must outlive it.
/// Source: docs/format.md, section "Latent segments".
class LatentCodeReader {
 public:
  explicit LatentCodeReader(SegmentSource& source) : source_(source) {}

  /// The latent of a row, without its remainder.
  Result<Latent> read(const std::string& group, uint64_t row);

 private:
  /// The holder of a row's code and the row's place in the block.
  struct Spot {
    uint64_t holder = 0;
    GroupPlace place;
  };
  struct Block {
    uint64_t holder = 0;
    Buffer code;
  };

  Result<Spot> spot(const std::string& group, uint64_t row);
  Status check_block(const std::string& group, uint64_t row, const Spot& spot);
  Status check_before(const std::string& group, uint64_t row, const Spot& spot);
  Result<Buffer> block(const std::string& group, uint64_t holder);

  SegmentSource& source_;
  /// Kept blocks by group; the one read last is at the end.
  std::map<std::string, std::vector<Block>> blocks_;
};

}  // namespace engram::ltm
