// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ltm/idf/ndarray.h"

namespace engram::memory {

/// uint8 [H, W, 3] (RGB), uint8 or uint16 [H, W, 1].
/// Errors: kInvalidArgument where it is no picture, has more pixels, which its header tells before
/// it is decoded, or transparency or other kinds of pixels.
Result<idf::NdArray> read_picture(std::span<const std::byte> bytes, int64_t max_pixels);

}  // namespace engram::memory
