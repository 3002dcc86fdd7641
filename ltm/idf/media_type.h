// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace engram::idf {

/// The pixels of an image. Shape: all images are [height, width, channels].
enum class PixelType : uint8_t {
  kRgb24,    ///< uint8, 3 channels in RGB order.
  kMono8,    ///< uint8, 1 channel.
  kDepth32,  ///< float32, 1 channel. Unit: m.
  kDepth16,  ///< uint16, 1 channel. Unit: mm.
};

/// The fields of a point, in the order of their letters. Shape: clouds are float32 [points,
/// fields]. Unit: m for x y z, 0..255 for colours. Labels are whole numbers up to 2^24.
/// Colours are separate numbers and not packed bits: packed colours cannot be averaged, bounded or
/// learned, and some of their bit patterns are NaN.
enum class PointType : uint8_t {
  kXyz,
  kXyzi,  ///< i: intensity, in the unit of the sensor.
  kXyzl,  ///< l: label.
  kXyzRgb,
  kXyzRgba,
  kXyzRgbl,
  kXyzNormal,  ///< x y z and the unit normal.
  kXyzRgbNormal,
};

/// "rgb24", "mono8", "depth32", "depth16".
[[nodiscard]] std::string_view to_string(PixelType pixel);
[[nodiscard]] std::optional<PixelType> pixel_type_from_name(std::string_view name);

/// "XYZ", "XYZI", "XYZRGB", "XYZRGBNormal", ...
[[nodiscard]] std::string_view to_string(PointType point);
[[nodiscard]] std::optional<PointType> point_type_from_name(std::string_view name);
[[nodiscard]] int64_t field_count(PointType point);

}  // namespace engram::idf
