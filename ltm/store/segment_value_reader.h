// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what segment files are read with.

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

/// Joins the values of rows from their tensor members and remainders, without media.
///
/// Threading: one thread. The source must outlive it.
/// Source: docs/format.md, section "Recorded segments".
class SegmentValueReader {
 public:
  explicit SegmentValueReader(SegmentSource& source) : source_(source), blocks_(source) {}

  /// The value of a row, `none` where its media were.
  /// Errors: kDataLoss.
  Result<idf::Data> value(const std::string& group, uint64_t row);

  /// The entry of a row in a group of remainders; the last block read is kept.
  /// Errors: kDataLoss.
  Result<idf::Data> remainder(const std::string& group, uint64_t row);

  /// Paths of the numbers of the entity that are stored as compressed columns.
  /// Errors: kDataLoss.
  Result<std::set<std::string, std::less<>>> columns(const std::string& group);

 private:
  /// A group of remainders, opened once.
  struct Remainder {
    uint64_t rows_per_block = 0;
    std::optional<ZstdDictionary> dictionary;  ///< Nothing where blocks were packed without one.
    std::optional<uint64_t> number;            ///< Of the last block read.
    idf::List rows;                            ///< Of it.
  };

  Result<idf::Layout> layout(const std::string& group);
  Result<Remainder*> remainder_of(const std::string& group);
  Result<Remainder> open_remainder(const std::string& group);
  Status read_block(const std::string& group, uint64_t number, Remainder& remainder);
  /// Where the members of a layout lie.
  struct Table {
    std::string path;
    NumberTable shape;
    bool are_blocks = false;
  };
  struct Member {
    size_t table = 0;   ///< Index into the tables.
    size_t offset = 0;  ///< Of its bytes in a row of the table.
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
