// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "ltm/idf/ndarray.h"
#include "ltm/typed/convert_value.h"

namespace engram::typed {

/// The pixels of a Mat as an array [height, width, channels], shared with it where the Mat owns
/// them without gaps, else copied (a part of a wider image, memory that somebody else owns).
/// Nothing for what no array can be: more than two axes, 16-bit floats.
///
/// Whoever keeps the Mat must not write into it any more: the array is immutable by contract. Take
/// a new Mat for the next picture, as `cv::Mat()` and then `read(mat)` do.
/// An empty Mat has the elements and channels of `pixel`.
[[nodiscard]] std::optional<idf::NdArray> array_of(const cv::Mat& mat, idf::PixelType pixel);

/// An array [height, width, channels] as a Mat over the same bytes, which live as long as the last
/// Mat on them. Nothing where OpenCV has no such Mat: another rank, a size above 2^31 - 1, more
/// than 512 channels, unsigned or wide integers.
///
/// Such a Mat is to be read. Clone it before you write to it: what lies below may be the memory's.
/// `mat = cv::Mat::zeros(...)` and `other.copyTo(mat)` write in place where size and kind are the
/// same; `mat = cv::Mat()` lets go of the bytes.
[[nodiscard]] std::optional<cv::Mat> mat_of(const idf::NdArray& array);

/// Shape: [height, width, channels]: rgb24 is CV_8UC3 in RGB order, mono8 CV_8UC1, depth32 CV_32FC1
/// in m, depth16 CV_16UC1 in mm. A Mat of another kind is written as it is, and idf::check says so;
/// one that no array can be becomes none.
template <>
struct Convert<cv::Mat> {
  static idf::Data write(const cv::Mat& value, const idf::Type& type);
  static bool read(const idf::Data& data, const idf::Type& type, cv::Mat& value);
  /// Equal size, kind and pixels, bit by bit.
  static bool equal(const cv::Mat& a, const cv::Mat& b);
};

}  // namespace engram::typed
