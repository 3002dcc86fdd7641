// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the rows of one array, read in blocks.

#include <optional>
#include <string>
#include <vector>

#include "datasets/hdf5/row_value.h"
#include "datasets/recordings/recording_reader.h"
#include "ltm/h5/h5.h"

namespace engram::datasets {

/// Reads the rows of an array in their order, a block of whole chunks at a time. A block has about
/// 1 MiB, or is one chunk if that is larger.
///
/// Threading: one thread.
class RowBlocks {
 public:
  RowBlocks(std::string path, h5::ArrayInfo info, RowRole role);

  [[nodiscard]] const h5::ArrayInfo& info() const { return info_; }

  /// Returns row `row`; rows must be read in order. Returns nothing if the row is damaged, which is
  /// counted in `report`.
  std::optional<idf::Data> value(const h5::File& file, uint64_t row, ReadingReport& report);

 private:
  void load(const h5::File& file, uint64_t row);
  bool read(const h5::File& file, uint64_t row, uint64_t rows);

  std::string path_;
  h5::ArrayInfo info_;
  RowRole role_;
  uint64_t block_rows_ = 1;
  uint64_t first_ = 0;
  uint64_t end_ = 0;  ///< Rows [first_, end_) are loaded or damaged.
  bool is_damaged_ = false;
  std::vector<std::byte> bytes_;
  std::vector<std::string> texts_;
};

}  // namespace engram::datasets
