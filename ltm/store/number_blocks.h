// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: numbers of segments as compressed columns.

#include <map>
#include <span>
#include <string>
#include <vector>

#include "ltm/store/segment_source.h"

namespace engram::ltm {

/// A table of numbers of one type. Each row has `columns` cells of `elements` numbers each.
struct NumberTable {
  idf::ElementType type = idf::ElementType::kFloat64;
  uint64_t rows = 0;
  size_t columns = 1;
  size_t elements = 1;

  [[nodiscard]] size_t cell_bytes() const { return elements * idf::size_bytes(type); }
  [[nodiscard]] size_t row_bytes() const { return columns * cell_bytes(); }
};

/// Max plain size of a block that is read, in bytes. It bounds memory, because a hostile file may
/// claim any size.
inline constexpr uint64_t kMaxNumberBlockBytes = uint64_t{1} << 30;

/// Writes row-major `cells` as blobs of compressed columns, one block of rows at a time.
/// Errors: kInvalidArgument if one row is larger than kMaxNumberBlockBytes; those of
/// h5::File::write.
/// Source: docs/format.md, "Columns".
Status write_number_blocks(h5::File& file, const std::string& group, const NumberTable& table,
                           std::span<const std::byte> cells);

/// Reads the rows that write_number_blocks wrote. It keeps the block read last of each table in
/// memory, up to a total of `kept_bytes`. Safe on hostile files.
///
/// Threading: one thread. The source must outlive it.
class NumberBlocks {
 public:
  /// Max plain bytes kept over all tables. One block is always kept, even if it is larger.
  static constexpr uint64_t kKeptBytes = uint64_t{256} << 20;

  explicit NumberBlocks(SegmentSource& source, uint64_t kept_bytes = kKeptBytes)
      : source_(source), kept_bytes_(kept_bytes) {}

  /// True if the numbers at `group` are stored as blocks, false if they are a plain dataset.
  /// Errors: kNotFound, kDataLoss.
  Result<bool> has(const std::string& group);

  /// The bytes of one row; valid until the next call.
  /// Errors: kDataLoss.
  Result<std::span<const std::byte>> row(const std::string& group, const NumberTable& table,
                                         uint64_t row);

  /// Plain bytes of the blocks that are kept now.
  [[nodiscard]] uint64_t held_bytes() const;

 private:
  struct Block {
    bool is_there = false;
    uint64_t rows_per_block = 0;
    uint64_t number = UINT64_MAX;  ///< Number of the block in `cells`.
    std::vector<std::byte> cells;  ///< Row-major.
    uint64_t last_use = 0;
  };

  Result<Block*> find(const std::string& group);
  Status load(const std::string& group, const NumberTable& table, uint64_t number, Block& block);
  void make_room(uint64_t bytes);

  SegmentSource& source_;
  uint64_t kept_bytes_;
  uint64_t uses_ = 0;
  std::map<std::string, Block> blocks_;
};

}  // namespace engram::ltm
