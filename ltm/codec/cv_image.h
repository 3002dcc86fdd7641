// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: image files in memory, through OpenCV.

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm::cv_image {

/// True for uint8 [H, W, 3], uint8 [H, W, 1] or, with `allows_16_bits`, uint16 [H, W, 1] with sides
/// up to `max_side`.
[[nodiscard]] bool fits(idf::ElementType type, const idf::Shape& shape, int64_t max_side,
                        bool allows_16_bits);

/// Encodes an image. `format` is the codec's name in messages and, with a dot before it, the file
/// extension for OpenCV.
/// Errors: kInvalidArgument if the encoder fails.
Result<std::vector<std::byte>> encode(std::string_view format, const idf::NdArray& array,
                                      const std::vector<int>& parameters);

/// Decodes an image. The caller must have checked the announced size, because it is allocated here.
/// Errors: kDataLoss if the bytes contain another image.
Result<idf::NdArray> decode(std::string_view format, std::span<const std::byte> bytes,
                            idf::ElementType type, const idf::Shape& shape);

}  // namespace engram::ltm::cv_image
