// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: images that a PNG or JPEG file can hold.

#include <utility>

#include "ltm/codec/image_file.h"
#include "ltm/idf/ndarray.h"

namespace engram::ltm {

/// True for uint8 [H, W, 3], uint8 [H, W, 1] or, with `allows_16_bits`, uint16 [H, W, 1] with sides
/// up to `max_side`.
[[nodiscard]] inline bool is_file_image(idf::ElementType type, const idf::Shape& shape,
                                        int64_t max_side, bool allows_16_bits) {
  if (shape.size() != 3 || shape[0] < 1 || shape[1] < 1 || shape[0] > max_side ||
      shape[1] > max_side)
    return false;
  if (type == idf::ElementType::kUInt8) return shape[2] == 1 || shape[2] == 3;
  return allows_16_bits && type == idf::ElementType::kUInt16 && shape[2] == 1;
}

/// Decodes what a file announces with `read`, which is read_png or read_jpeg.
/// Errors: kDataLoss if the file is damaged or holds another image.
template <typename Read>
Result<idf::NdArray> read_announced(std::span<const std::byte> file,
                                    const AnnouncedImage& announced, const Read& read) {
  Result<idf::NdArray> image = read(file, announced.shape[0] * announced.shape[1]);
  if (!image.ok()) return data_loss("{}", image.status().message());
  if (image->type() != announced.type || image->shape() != announced.shape)
    return data_loss("{}: announced {} {}, holds {} {}", announced.codec, to_string(announced.type),
                     idf::to_string(announced.shape), to_string(image->type()),
                     idf::to_string(image->shape()));
  return image;
}

}  // namespace engram::ltm
