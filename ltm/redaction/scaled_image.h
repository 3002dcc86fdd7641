// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: images for OpenCV's detectors.

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "ltm/redaction/detector.h"

namespace engram::ltm {

/// The sides between which detectors of gradients see an image: smaller ones are enlarged, because
/// they look for at least some 100 pixels of a person (192 x 108: boxes in 77 of 139 images with
/// 640, in 34 with 400), larger ones are reduced, because the time grows with the pixels. Unit:
/// pixels of the longer side.
inline constexpr int kMinSeenSide = 640;
inline constexpr int kMaxSeenSide = 1280;
/// Images with a shorter side show nobody. Unit: pixels.
inline constexpr int kMinDetectedSide = 16;

/// The image in OpenCV's form, without a copy.
inline cv::Mat as_mat(const DetectorImage& image) {
  return {image.height, image.width, CV_MAKETYPE(CV_8U, image.channels),
          const_cast<uint8_t*>(image.pixels.data())};
}

inline cv::Mat as_grey(const DetectorImage& image) {
  if (image.channels == 1) return as_mat(image);
  cv::Mat grey;
  cv::cvtColor(as_mat(image), grey, cv::COLOR_RGB2GRAY);
  return grey;
}

/// An image in grey, and how much larger than the given one it is.
struct ScaledImage {
  cv::Mat grey;
  double scale = 1;
};

inline ScaledImage scaled_grey(const DetectorImage& image) {
  ScaledImage scaled{as_grey(image), 1};
  const int side = std::max(image.width, image.height);
  const int seen = std::clamp(side, kMinSeenSide, kMaxSeenSide);
  if (seen == side) return scaled;
  scaled.scale = static_cast<double>(seen) / side;
  const cv::Size size(std::max(1, static_cast<int>(image.width * scaled.scale)),
                      std::max(1, static_cast<int>(image.height * scaled.scale)));
  cv::resize(scaled.grey, scaled.grey, size, 0, 0,
             scaled.scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  return scaled;
}

inline bool is_too_small(const DetectorImage& image) {
  return std::min(image.width, image.height) < kMinDetectedSide;
}

inline std::vector<Box> unscaled(const std::vector<cv::Rect>& found, double scale) {
  std::vector<Box> boxes;
  for (const cv::Rect& one : found)
    if (boxes.size() < kMaxBoxes)
      boxes.push_back({one.x / scale, one.y / scale, one.width / scale, one.height / scale});
  return boxes;
}

}  // namespace engram::ltm
