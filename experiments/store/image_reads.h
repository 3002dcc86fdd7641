// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "ltm/core/buffer.h"
#include "ltm/recall/recall.h"
#include "store/stream.h"

namespace engram::experiments {

/// An image to look for.
struct ImageRead {
  size_t camera = 0;
  size_t tick = 0;
};

/// Random ones, equal for equal seeds. Needs a stream of at least one tick (checked).
[[nodiscard]] std::vector<ImageRead> draw_reads(const Stream& stream, size_t count,
                                                uint64_t seed = 1);

/// The pixels that a camera showed at exactly this time.
/// Errors: those of the query; kNotFound naming camera and time.
Result<Buffer> read_image(ltm::Recall& recall, size_t camera, Time time);

/// Whether these are the pixels that a camera showed at a tick.
/// Errors: kDataLoss naming camera and time where they are not.
Status expect_image(const Buffer& found, const Stream& stream, const ImageRead& read);

}  // namespace engram::experiments
