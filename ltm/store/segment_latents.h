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

/// Codes of latents, one per row; those of a block are stored once, by its first row.
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

/// Reads codes of latents; rows of one block share its bytes. Of each part the last blocks are
/// kept.
///
/// Errors: kDataLoss naming file, object and row, everywhere.
/// Threading: one thread. The source must outlive it.
/// Source: docs/format.md, section "Latent segments".
class LatentCodeReader {
 public:
  explicit LatentCodeReader(SegmentSource& source) : source_(source) {}

  /// The latent of a row, without its remainder.
  Result<Latent> read(const std::string& group, uint64_t row);

 private:
  /// Where the code of a row lies.
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
  std::map<std::string, std::vector<Block>> blocks_;  ///< By group, read last at the end.
};

}  // namespace engram::ltm
