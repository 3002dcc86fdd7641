// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: parts of the segment reader.

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "ltm/codec/zstd_dictionary.h"
#include "ltm/idf/layout.h"
#include "ltm/store/number_blocks.h"
#include "ltm/store/segment_source.h"

namespace engram::ltm {

/// Assembles the values of rows from their tensor members and remainders, without media.
///
/// Threading: one thread. The source must outlive it.
/// Source: docs/format.md, section "Recorded segments".
class SegmentValueReader {
 public:
  explicit SegmentValueReader(SegmentSource& source) : source_(source), blocks_(source) {}

  /// The value of a row, with `none` in place of its media.
  /// Errors: kDataLoss.
  Result<idf::Data> value(const std::string& group, uint64_t row);

  /// The entry of a row in a group of remainders. The block read last is kept.
  /// Errors: kDataLoss.
  Result<idf::Data> remainder(const std::string& group, uint64_t row);

  /// Paths of the entity's numbers that are stored as compressed columns.
  /// Errors: kDataLoss.
  Result<std::set<std::string, std::less<>>> columns(const std::string& group);

 private:
  /// A group of remainders, opened once.
  struct Remainder {
    uint64_t rows_per_block = 0;
    std::optional<ZstdDictionary> dictionary;  ///< nullopt if the blocks were packed without one.
    std::optional<uint64_t> number;            ///< Number of the block read last.
    idf::List rows;                            ///< Rows of that block.
  };

  Result<idf::Layout> layout(const std::string& group);
  Result<Remainder*> remainder_of(const std::string& group);
  Result<Remainder> open_remainder(const std::string& group);
  Status read_block(const std::string& group, uint64_t number, Remainder& remainder);
  /// A dataset or group that stores members of a layout.
  struct Table {
    std::string path;
    NumberTable shape;
    bool are_blocks = false;
  };
  struct Member {
    size_t table = 0;   ///< Index into the tables.
    size_t offset = 0;  ///< Offset of its bytes in a row of the table.
  };
  struct Tables {
    idf::Layout layout;
    std::vector<Table> tables;
    std::vector<Member> members;  ///< In the order of the layout.
  };

  Result<Tables*> tables_of(const std::string& group);
  Result<Tables> open_tables(const std::string& group);
  Result<std::vector<idf::NdArray>> tensors(Tables& tables, uint64_t row);
  Result<std::span<const std::byte>> row_of(const Table& table, uint64_t row);

  SegmentSource& source_;
  NumberBlocks blocks_;
  std::map<std::string, Tables> tables_;
  std::map<std::string, Remainder> remainders_;
};

}  // namespace engram::ltm
