// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "ltm/idf/ndarray.h"
#include "ltm/typed/convert_value.h"

namespace engram::typed {

/// The pixels of a Mat as an array [height, width, channels]. It shares them where the Mat owns
/// them without gaps, and copies them otherwise (a part of a wider image, memory of another owner).
/// Nothing where no array is possible: more than two axes, 16-bit floats.
///
/// Nobody may write to the Mat afterwards, because the array is immutable. Use a new Mat for the
/// next image, as `cv::Mat()` and then `read(mat)` do. An empty Mat has the elements and channels
/// of `pixel`.
[[nodiscard]] std::optional<idf::NdArray> array_of(const cv::Mat& mat, idf::PixelType pixel);

/// An array [height, width, channels] as a Mat over the same bytes, which live as long as the last
/// Mat on them. Nothing where OpenCV has no such Mat: another rank, a size above 2^31 - 1, more
/// than 512 channels, unsigned or wide integers.
///
/// Such a Mat may only be read. Clone it before you write to it, because its bytes may belong to
/// the memory. `mat = cv::Mat::zeros(...)` and `other.copyTo(mat)` write in place where size and
/// kind are equal; `mat = cv::Mat()` releases the bytes.
[[nodiscard]] std::optional<cv::Mat> mat_of(const idf::NdArray& array);

/// Shape: [height, width, channels]: rgb24 is CV_8UC3 in RGB order, mono8 CV_8UC1, depth32 CV_32FC1
/// in m, depth16 CV_16UC1 in mm. A Mat of another kind is written as it is, and idf::check reports
/// it; a Mat that cannot be an array becomes none.
template <>
struct Convert<cv::Mat> {
  static idf::Data write(const cv::Mat& value, const idf::Type& type);
  static bool read(const idf::Data& data, const idf::Type& type, cv::Mat& value);
  /// Equal size, kind and pixels, bit by bit.
  static bool equal(const cv::Mat& a, const cv::Mat& b);
};

}  // namespace engram::typed
