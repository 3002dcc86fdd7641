// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// What a PNG or JPEG file says that it holds, before anything is decoded.
struct AnnouncedImage {
  std::string_view codec;  ///< "png" or "jpeg", as find_codec knows them.
  idf::ElementType type = idf::ElementType::kUInt8;
  idf::Shape shape;  ///< [H, W, 3] (RGB) or [H, W, 1] (grey).
};

/// Nothing where the bytes are no such file, or one of another kind: with transparency, a palette,
/// RGB of 16 bits, CMYK.
[[nodiscard]] std::optional<AnnouncedImage> announced_image(std::span<const std::byte> file);

/// Decodes a whole file that nobody vouches for.
/// Shape: uint8 [H, W, 3] or [H, W, 1], uint16 [H, W, 1].
/// Errors: kInvalidArgument where nothing is announced, or more than 256 MiB of pixels; kDataLoss
/// where it is broken.
Result<idf::NdArray> decode_image_file(std::span<const std::byte> file);

}  // namespace engram::ltm
