// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// The image that a PNG or JPEG file announces, read before anything is decoded.
struct AnnouncedImage {
  std::string_view codec;  ///< "png" or "jpeg", as find_codec knows them.
  idf::ElementType type = idf::ElementType::kUInt8;
  idf::Shape shape;  ///< [H, W, 3] (RGB) or [H, W, 1] (grey).
};

/// Reads the announced image. Returns nullopt if the bytes are not a PNG or JPEG file, or one of an
/// unsupported kind: with transparency, a palette, 16-bit RGB or CMYK.
[[nodiscard]] std::optional<AnnouncedImage> announced_image(std::span<const std::byte> file);

/// Decodes a whole file from an untrusted source.
/// Shape: uint8 [H, W, 3] or [H, W, 1], uint16 [H, W, 1].
/// Errors: kInvalidArgument if no image is announced, or one of more than 256 MiB of pixels;
/// kDataLoss if the file is damaged.
Result<idf::NdArray> decode_image_file(std::span<const std::byte> file);

/// As decode_image_file, and also what announced_image does not know: palettes and grey of fewer
/// than 8 bits, which become 8 bits, and files with anything between their segments.
/// Errors: kInvalidArgument if it is no PNG or JPEG file, or has transparency, RGB of 16 bits or
/// CMYK; kDataLoss if it is damaged or has more than `max_pixels`.
Result<idf::NdArray> decode_any_image_file(std::span<const std::byte> file, int64_t max_pixels);

}  // namespace engram::ltm
