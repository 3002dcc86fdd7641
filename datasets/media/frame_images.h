// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <opencv2/core.hpp>

#include "datasets/media/decoded_picture.h"
#include "datasets/media/libav_input.h"
#include "datasets/media/video_reader.h"

namespace engram::datasets {

/// Converts decoded frames to RGB images of one size: converts colours, crops and scales.
///
/// Threading: one thread.
class FrameImages {
 public:
  FrameImages(const VideoInfo& info, const VideoReader::Options& options);

  /// Shape: uint8 [H, W, 3]. The size is always the same; a frame of another shape is cropped.
  /// Errors: kInvalidArgument if the colours cannot be converted or the frame cannot be scaled.
  Result<idf::NdArray> make(const DecodedPicture& picture);

  [[nodiscard]] idf::Shape shape() const { return {size_.height, size_.width, 3}; }

 private:
  Result<idf::NdArray> convert(AVFrame& frame);
  Status prepare(const libav::PixelFormat& format, bool scales);
  [[nodiscard]] bool can_scale_planes(const libav::PixelFormat& format, const cv::Rect& crop) const;
  [[nodiscard]] idf::NdArray fit(const cv::Mat& from) const;

  cv::Size size_;
  bool crops_square_;
  libav::PixelFormat format_;  ///< The format of the last frame.
  libav::Scaler converter_;    ///< Converts from `format_`.
  cv::Mat rgb_;                ///< The last frame, possibly scaled, before it is cropped.
};

}  // namespace engram::datasets
