// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/idf/ndarray.h"

// Private to this room.

namespace engram::augmentation {

/// What the pixels of an image mean, which decides how they may be changed.
enum class PixelRole {
  kLight,  ///< uint8 [H, W, 3] (RGB) or [H, W, 1]: light that a camera saw.
  kDepth,  ///< uint16 or float32 [H, W, 1]; 0 where the depth is unknown.
  kLabel,  ///< uint8 or uint16 [H, W, 1]: the object that is seen; 0 for no object.
};

struct SceneImage {
  std::string path;  ///< Path of the member in the value.
  PixelRole role = PixelRole::kLight;
  cv::Mat pixels;  ///< A continuous matrix that owns its memory.
};

/// Coordinates in pixels of the first image: x, y, x, y, ...
struct ScenePoints {
  std::string path;
  std::vector<double> coordinates;
};

/// The images of one instance while they are changed, with the labels and points that belong to
/// them.
struct SceneImages {
  std::vector<SceneImage> images;
  std::vector<ScenePoints> points;
  /// Labels of another entity. They move with the view but are not written back; may be empty.
  cv::Mat labels;

  /// Returns a mask of the given size that is 255 where the object is seen. `label` 0 selects any
  /// object. The mask is empty if no labels are known.
  [[nodiscard]] cv::Mat mask_of(int64_t label, cv::Size size) const;
};

/// Copies an image. Errors: kInvalidArgument if its type and shape fit no PixelRole.
Result<cv::Mat> to_mat(const idf::NdArray& array);

[[nodiscard]] idf::NdArray to_array(const cv::Mat& pixels, const idf::NdArray& as);

}  // namespace engram::augmentation
