// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room.

#include <opencv2/core.hpp>

#include "datasets/media/decoded_picture.h"
#include "datasets/media/libav_input.h"
#include "datasets/media/video_reader.h"

namespace engram::datasets {

/// Turns decoded frames into RGB images of one size: converts their colours, crops and scales.
///
/// Threading: one thread.
class FrameImages {
 public:
  FrameImages(const VideoInfo& info, const VideoReader::Options& options);

  /// Shape: uint8 [H, W, 3], the same size whatever that of the frame is, which is cropped.
  /// Errors: kInvalidArgument where its colours cannot be converted, or it cannot be scaled.
  Result<idf::NdArray> make(const DecodedPicture& picture);

  [[nodiscard]] idf::Shape shape() const { return {size_.height, size_.width, 3}; }

 private:
  Result<idf::NdArray> convert(AVFrame& frame);
  Status prepare(const libav::PixelFormat& format, bool scales);
  [[nodiscard]] bool can_scale_planes(const libav::PixelFormat& format, const cv::Rect& crop) const;
  [[nodiscard]] idf::NdArray fit(const cv::Mat& from) const;

  cv::Size size_;
  bool crops_square_;
  libav::PixelFormat format_;  ///< Of the last frame.
  libav::Scaler converter_;    ///< From that format.
  cv::Mat rgb_;                ///< The last frame, scaled or not, before it is cropped.
};

}  // namespace engram::datasets
