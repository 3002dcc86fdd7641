// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: numbers of segments as compressed columns.

#include <map>
#include <span>
#include <string>
#include <vector>

#include "ltm/store/segment_source.h"

namespace engram::ltm {

/// Numbers of one type: `columns` columns, in each row `elements` numbers of every column.
struct NumberTable {
  idf::ElementType type = idf::ElementType::kFloat64;
  uint64_t rows = 0;
  size_t columns = 1;
  size_t elements = 1;

  [[nodiscard]] size_t cell_bytes() const { return elements * idf::size_bytes(type); }
  [[nodiscard]] size_t row_bytes() const { return columns * cell_bytes(); }
};

/// The most plain bytes of a block that are read: a hostile file may tell of any size.
inline constexpr uint64_t kMaxNumberBlockBytes = uint64_t{1} << 30;

/// Writes the cells, row-major, as blobs of compressed columns, a block of rows at a time.
/// Errors: kInvalidArgument where one row has more than kMaxNumberBlockBytes; those of
/// h5::File::write.
/// Source: docs/format.md, "Columns".
Status write_number_blocks(h5::File& file, const std::string& group, const NumberTable& table,
                           std::span<const std::byte> cells);

/// Reads such rows; the last block of each table is kept, as far as they fit. Safe on hostile
/// files.
///
/// Threading: one thread. The source must outlive it.
class NumberBlocks {
 public:
  /// The most plain bytes that are kept over all tables, though always one block.
  static constexpr uint64_t kKeptBytes = uint64_t{256} << 20;

  explicit NumberBlocks(SegmentSource& source, uint64_t kept_bytes = kKeptBytes)
      : source_(source), kept_bytes_(kept_bytes) {}

  /// True where the numbers at `group` are blocks, false where they are a plain dataset.
  /// Errors: kNotFound, kDataLoss.
  Result<bool> has(const std::string& group);

  /// The bytes of one row; valid until the next call.
  /// Errors: kDataLoss.
  Result<std::span<const std::byte>> row(const std::string& group, const NumberTable& table,
                                         uint64_t row);

  /// Plain bytes that are kept now.
  [[nodiscard]] uint64_t held_bytes() const;

 private:
  struct Block {
    bool is_there = false;
    uint64_t rows_per_block = 0;
    uint64_t number = UINT64_MAX;  ///< Of the block in `cells`.
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
