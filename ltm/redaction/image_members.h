// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: the images of a value, and what is done to their parts.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "ltm/idf/data.h"

namespace engram::ltm {

/// How an array holds images. Steps count elements.
struct ImageLayout {
  int64_t images = 1;
  int64_t height = 0;
  int64_t width = 0;
  int64_t channels = 1;
  int64_t image_step = 0;
  int64_t row_step = 0;
  int64_t column_step = 1;
  int64_t channel_step = 1;
};

/// Arrays with shorter sides show nothing that one could recognise, and are no images. Unit:
/// pixels.
inline constexpr int64_t kMinImageSide = 8;

/// The layout of an array that may be an image: [H, W, C], [C, H, W] with 1 to 4 channels, [H, W]
/// from 32 x 32 on, or a list of such images. It asks for less than idf::MemberKind::kImage:
/// numbers of any kind, any place of the channels. An array that is none loses nothing if a
/// detector looks at it. Nothing for float [N, 3 to 16], which are point clouds.
[[nodiscard]] std::optional<ImageLayout> image_layout_of(idf::ElementType type,
                                                         const idf::Shape& shape);

/// An array of a value that holds images.
struct ImageMember {
  std::string path;
  idf::NdArray* array = nullptr;  ///< Valid as long as the value does not change otherwise.
  ImageLayout layout;
};

/// The images of a value, nested ones, too.
struct FoundImages {
  std::vector<ImageMember> members;
  /// The path of an array or text that begins like a JPEG or another file of images or video, in
  /// which no detector looks; nothing: there is none.
  std::optional<std::string> encoded;
};

[[nodiscard]] FoundImages find_images(idf::Data& value);

/// One image for a detector. Shape: [height, width, 1 or 3]; RGB.
struct GreyOrRgb {
  int channels = 1;
  std::vector<uint8_t> pixels;
};

/// Image `index` of an array. Numbers that are not uint8 are stretched so that the smallest becomes
/// 0 and the largest 255; others than finite ones become 0. The fourth channel is left out, and so
/// is the second of two.
[[nodiscard]] GreyOrRgb pixels_of(const idf::NdArray& array, const ImageLayout& layout,
                                  int64_t index);

/// A part of an image that is within it, [left, right) x [top, bottom). Unit: pixels.
struct ImagePart {
  int64_t image = 0;
  int64_t left = 0, top = 0, right = 0, bottom = 0;
};

/// Makes parts of an array unrecognisable in a copy of it: at most kMaxBlocks blocks along the
/// longer side of a part, each of one value, or zeros.
void pixelate(idf::NdArray& array, const ImageLayout& layout, const std::vector<ImagePart>& parts);
void fill(idf::NdArray& array, const ImageLayout& layout, const std::vector<ImagePart>& parts);

/// Blocks of a part along its longer side. Eight leave of a face some 30 numbers.
inline constexpr int64_t kMaxBlocks = 8;
/// Smaller blocks would leave a small part as it was. Unit: pixels.
inline constexpr int64_t kMinBlock = 6;

}  // namespace engram::ltm
