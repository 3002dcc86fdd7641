// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/recall/recall.h"
#include "store/stream.h"

namespace engram::experiments {

/// An image to read.
struct ImageRead {
  size_t camera = 0;
  size_t tick = 0;
};

/// Draws random reads, equal for equal seeds. The stream must have at least one tick (checked).
[[nodiscard]] std::vector<ImageRead> draw_reads(const Stream& stream, size_t count,
                                                uint64_t seed = 1);

/// Reads the pixels of a camera at exactly this time.
/// Errors: those of the query; kNotFound naming camera and time.
Result<Buffer> read_image(ltm::Recall& recall, size_t camera, Time time);

/// Compares pixels with those that a camera showed at a tick.
/// Errors: kDataLoss naming camera and time if they differ.
Status expect_image(const Buffer& found, const Stream& stream, const ImageRead& read);

}  // namespace engram::experiments
