// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: images and videos in bytes, in which no detector looks.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "ltm/idf/data.h"

namespace engram::ltm {

/// Whether bytes begin as files or packets of images or video do: JPEG, PNG and others, behind the
/// 12 bytes of ROS' compressedDepth, too; MP4, Matroska and others; H.264, HEVC and MPEG with start
/// codes or lengths, whatever unit comes first; and files as base64 in texts. It asks for little,
/// so other bytes may be taken for video: whoever keeps no images loses them then. Safe on hostile
/// bytes.
/// Complexity: O(1) but for H.264 with lengths, whose units are counted.
[[nodiscard]] bool begins_as_image_or_video(std::span<const std::byte> bytes);

/// The member of a message that holds an image or video as bytes by what the other members say:
/// `width` and `height` beside bytes, as sensor_msgs/Image has them, or a `format` or `encoding` of
/// images or video, as CompressedImage has one. Nothing for point clouds, which have a
/// `point_step`.
/// Complexity: O(members).
[[nodiscard]] std::optional<std::string> image_bytes_of(const idf::Dict& message);

}  // namespace engram::ltm
