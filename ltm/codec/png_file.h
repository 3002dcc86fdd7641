// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: PNG files in memory, through libspng.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// Encodes an image as is_file_image has it, 16 bits included. `level`: 0 to 9 as zlib has it;
/// empty: as fast as possible, with one filter and runs only.
/// Errors: kInvalidArgument if the encoder fails.
Result<std::vector<std::byte>> write_png(const idf::NdArray& image, std::optional<int> level);

/// Decodes a file from an untrusted source. Palettes and fewer than 8 bits become 8 bits.
/// Shape: uint8 [H, W, 3] or [H, W, 1], uint16 [H, W, 1].
/// Errors: kDataLoss if the file is damaged or has more than `max_pixels`; kInvalidArgument if it
/// has transparency, or RGB of 16 bits.
Result<idf::NdArray> read_png(std::span<const std::byte> file, int64_t max_pixels);

}  // namespace engram::ltm
