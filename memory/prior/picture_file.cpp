// SPDX-License-Identifier: Apache-2.0
#include "memory/prior/picture_file.h"

#include "ltm/codec/image_file.h"

namespace engram::memory {

Result<idf::NdArray> read_picture(std::span<const std::byte> bytes, int64_t max_pixels) {
  auto image = ltm::decode_any_image_file(bytes, max_pixels);
  if (!image.ok()) return invalid_argument("is no picture to take: {}", image.status().message());
  return image;
}

}  // namespace engram::memory
