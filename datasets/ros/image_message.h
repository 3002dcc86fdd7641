// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "ltm/idf/data.h"

namespace engram::datasets::ros {

/// Converts sensor_msgs/Image to a picture: {"image" or "depth", "alpha" if it has one, "header",
/// "encoding"}. Padding of rows is removed, and the byte order becomes the machine's. A message
/// with an unknown encoding, or with sizes that contradict each other, is returned unchanged.
[[nodiscard]] idf::Data picture_of_image(idf::Data message);

/// Converts a picture back to the message; other values are returned unchanged. If `value` has no
/// encoding, it follows from the array.
/// Errors: kInvalidArgument if array and encoding contradict each other, or if there are members
/// that an image cannot hold.
Result<idf::Data> image_of_picture(const idf::Data& value);

/// Converts sensor_msgs/CompressedImage with PNG or JPEG to {"image" or "depth", "header"}. A
/// message that cannot be decoded without changing it is returned unchanged.
[[nodiscard]] idf::Data picture_of_compressed(idf::Data message);

/// Converts a picture back to the message, as PNG or, with a quality of 1 to 100 and if it has 8
/// bits, as JPEG.
/// Errors: kInvalidArgument if these cannot hold the array or another member.
Result<idf::Data> compressed_of_picture(const idf::Data& value, int jpeg_quality);

/// Errors: kInvalidArgument naming a member of `value` that is not one of `members`, or saying that
/// it has both an image and a depth.
[[nodiscard]] Status check_members(const idf::Data& value,
                                   std::initializer_list<std::string_view> members);

}  // namespace engram::datasets::ros
