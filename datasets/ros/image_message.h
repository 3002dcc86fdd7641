// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "ltm/idf/data.h"

namespace engram::datasets::ros {

/// sensor_msgs/Image as a picture: {"image" or "depth", "alpha" where it has one, "header",
/// "encoding"}. Padding of rows goes, byte order becomes the machine's. A message whose encoding is
/// not known, or whose sizes contradict each other, stays as it is.
[[nodiscard]] idf::Data picture_of_image(idf::Data message);

/// The message again; what is no picture stays as it is. Where `value` has no encoding it follows
/// from the array.
/// Errors: kInvalidArgument where array and encoding contradict each other, or where there are
/// members that an image cannot hold.
Result<idf::Data> image_of_picture(const idf::Data& value);

/// sensor_msgs/CompressedImage of PNG or JPEG as {"image" or "depth", "header"}. What cannot be
/// decoded, or not without changing it, stays as it is.
[[nodiscard]] idf::Data picture_of_compressed(idf::Data message);

/// The message again, as PNG or, with a quality of 1 to 100 and where there are 8 bits, JPEG.
/// Errors: kInvalidArgument where the array, or another member, is none that these can hold.
Result<idf::Data> compressed_of_picture(const idf::Data& value, int jpeg_quality);

/// Errors: kInvalidArgument naming a member of `value` that is none of these, or that it has both
/// an image and a depth.
[[nodiscard]] Status check_members(const idf::Data& value,
                                   std::initializer_list<std::string_view> members);

}  // namespace engram::datasets::ros
