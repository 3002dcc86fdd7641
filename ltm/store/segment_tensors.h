// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: what segment files are written of.

#include <string>
#include <vector>

#include "ltm/codec/seal_rules.h"
#include "ltm/h5/h5.h"
#include "ltm/idf/layout.h"
#include "ltm/store/segment_rows.h"

namespace engram::ltm {

/// The layout that most rows have; the others are kept whole in the remainder. Columns are for
/// the many: where fewer than half of the rows would fill them, there are none.
[[nodiscard]] idf::Layout most_common_layout(const std::vector<SegmentRow>& rows);

/// The tensor members of the rows as datasets: scalars of one type share a matrix. Where the rules
/// say so they become compressed columns, the whole matrix where they say so of any of it.
///
/// Layout and rules must outlive it.
class TensorColumns {
 public:
  TensorColumns(const idf::Layout& layout, size_t rows, const SealRules& rules);

  /// `tensors` in the order of the layout's members.
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
