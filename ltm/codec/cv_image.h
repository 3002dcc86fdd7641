// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: image files in memory, through OpenCV.

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "ltm/idf/ndarray.h"

namespace engram::ltm::cv_image {

/// uint8 [H, W, 3], uint8 or, with `allows_16_bits`, uint16 [H, W, 1] of sides up to `max_side`.
[[nodiscard]] bool fits(idf::ElementType type, const idf::Shape& shape, int64_t max_side,
                        bool allows_16_bits);

/// `format` names the codec in messages and, with a dot before it, the file format.
/// Errors: kInvalidArgument where the encoder refuses.
Result<std::vector<std::byte>> encode(std::string_view format, const idf::NdArray& array,
                                      const std::vector<int>& parameters);

/// Errors: kDataLoss where the bytes hold another image. The caller has checked the size that
/// they announce: it is allocated here.
Result<idf::NdArray> decode(std::string_view format, std::span<const std::byte> bytes,
                            idf::ElementType type, const idf::Shape& shape);

}  // namespace engram::ltm::cv_image
