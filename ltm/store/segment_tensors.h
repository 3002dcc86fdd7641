// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: parts of the segment writer.

#include <string>
#include <vector>

#include "ltm/codec/seal_rules.h"
#include "ltm/h5/h5.h"
#include "ltm/idf/layout.h"
#include "ltm/store/segment_rows.h"

namespace engram::ltm {

/// The most common layout of the rows. Rows of other layouts are kept whole in the remainder. If
/// fewer than half of the rows share a layout there are no columns, since most of their cells would
/// be empty.
[[nodiscard]] idf::Layout most_common_layout(const std::vector<SegmentRow>& rows);

/// The tensor members of the rows as datasets. Scalars of one type share a matrix. Members become
/// compressed columns if the rules say so; a matrix becomes compressed if the rules say so for any
/// of its members.
///
/// Layout and rules must outlive it.
class TensorColumns {
 public:
  TensorColumns(const idf::Layout& layout, size_t rows, const SealRules& rules);

  /// Sets the tensors of a row, given in the order of the layout's members.
  void set(size_t row, const std::vector<idf::NdArray>& tensors);

  /// Errors: those of h5::File::write.
  Status write(h5::File& file, const std::string& group) const;

 private:
  Status write_array(h5::File& file, const std::string& group, size_t index) const;
  Status write_scalars(h5::File& file, const std::string& group,
                       const std::vector<size_t>& members) const;

  const idf::Layout& layout_;
  size_t rows_;
  const SealRules& rules_;
  std::vector<std::vector<std::byte>> values_;
};

}  // namespace engram::ltm
