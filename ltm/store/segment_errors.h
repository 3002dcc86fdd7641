// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ltm/h5/h5.h"
#include "ltm/store/latent.h"
#include "ltm/store/segment_source.h"

// Private to this room.

namespace engram::ltm {

/// The columns of a latent segment that tell how good its rows are. What only faded rows have is
/// not written where no row faded.
///
/// Source: docs/format.md, "Latent segments".
class ErrorColumns {
 public:
  void append(const LatentQuality& quality);
  Status write(h5::File& file, const std::string& group) const;

 private:
  std::vector<double> image_mse_, number_mse_, image_bound_, number_bound_;
  std::vector<float> faded_to_db_;
};

/// Reads what ErrorColumns wrote for a row.
/// Errors: kDataLoss.
Result<LatentQuality> read_quality(SegmentSource& source, const std::string& group, uint64_t row);

}  // namespace engram::ltm
