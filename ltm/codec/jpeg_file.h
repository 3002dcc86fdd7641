// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: JPEG files in memory, through libjpeg-turbo.

#include <cstddef>
#include <span>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// Encodes uint8 [H, W, 3] (with half as many colours each way) or [H, W, 1]. `quality`: 1 to 100.
/// Errors: kInvalidArgument if the encoder fails.
Result<std::vector<std::byte>> write_jpeg(const idf::NdArray& image, int quality);

/// Decodes a file from an untrusted source. Of damaged data the decoder makes what it can.
/// Shape: uint8 [H, W, 3] or [H, W, 1].
/// Errors: kDataLoss if the file is damaged or has more than `max_pixels`; kInvalidArgument if its
/// colours are CMYK.
Result<idf::NdArray> read_jpeg(std::span<const std::byte> file, int64_t max_pixels);

}  // namespace engram::ltm
