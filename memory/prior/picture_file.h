// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "ltm/idf/ndarray.h"

namespace engram::memory {

/// Decodes a PNG or JPEG file.
/// Shape: uint8 [H, W, 3] (RGB), uint8 or uint16 [H, W, 1].
/// Errors: kInvalidArgument where the bytes are no picture, where it has more than `max_pixels`
/// (its header is checked before it is decoded), transparency or other kinds of pixels.
Result<idf::NdArray> read_picture(std::span<const std::byte> bytes, int64_t max_pixels);

}  // namespace engram::memory
