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

  /// How many looks an image takes until all its channels were seen: three of them together as RGB,
  /// each other one as grey.
  [[nodiscard]] int64_t looks() const { return channels < 3 ? channels : channels - 2; }
};

/// Arrays with shorter sides show nothing that one could recognise, and are no images. Unit:
/// pixels.
inline constexpr int64_t kMinImageSide = 8;

/// The layout of an array that may be an image: [H, W, C] with 1 to 7 channels, [C, H, W] with 1 to
/// 4, [H, W] from 32 x 32 on, or images of these forms behind any number of further axes. It asks
/// for less than idf::MemberKind::kImage: numbers of any kind, any place of the channels. An array
/// that is none loses nothing if a detector looks at it. Three planes are one RGB image, five or
/// more are grey images; floats of two axes and lists of these count from 32 x 32 on.
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
  /// Why no detector can look at all of it: a member that is like a JPEG or another file of images
  /// or video, has pixels as bytes, or may have images in another layout. Empty: it can.
  std::string unreadable;

  /// How many looks they take.
  [[nodiscard]] int64_t looks() const;
};

[[nodiscard]] FoundImages find_images(idf::Data& value);

/// One image for a detector. Shape: [height, width, 1 or 3]; RGB.
struct GreyOrRgb {
  int channels = 1;
  std::vector<uint8_t> pixels;
};

/// Image `index` of an array, in the look `look` of ImageLayout::looks. Numbers that are not uint8
/// are stretched so that the smallest becomes 0 and the largest 255; others than finite ones become
/// 0.
[[nodiscard]] GreyOrRgb pixels_of(const idf::NdArray& array, const ImageLayout& layout,
                                  int64_t index, int64_t look = 0);

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
