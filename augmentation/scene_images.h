// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "ltm/idf/data.h"
#include "ltm/idf/ndarray.h"

// Private to this room.

namespace engram::augmentation {

/// What the pixels of an image mean: what may be done to them.
enum class PixelRole {
  kLight,  ///< uint8 [H, W, 3] (RGB) or [H, W, 1]: light that a camera saw.
  kDepth,  ///< uint16 or float32 [H, W, 1]; 0 where unknown.
  kLabel,  ///< uint8 or uint16 [H, W, 1]: which object is seen; 0 where none.
};

struct SceneImage {
  std::string path;  ///< In the value.
  PixelRole role = PixelRole::kLight;
  cv::Mat pixels;  ///< Its own, continuous.
};

/// Places in pixels of the first image: x, y, x, y, ...
struct ScenePoints {
  std::string path;
  std::vector<double> coordinates;
};

/// The images of one instance while they are changed, and what belongs to them.
struct SceneImages {
  std::vector<SceneImage> images;
  std::vector<ScenePoints> points;
  /// Labels of another entity, which moves along and is not kept; may be empty.
  cv::Mat labels;

  /// Bytes 255 where an object is seen, of the given size; empty where no labels are known.
  /// `label` 0: any object.
  [[nodiscard]] cv::Mat mask_of(int64_t label, cv::Size size) const;
};

/// A copy of an image. Errors: kInvalidArgument where no role takes it.
Result<cv::Mat> to_mat(const idf::NdArray& array);

[[nodiscard]] idf::NdArray to_array(const cv::Mat& pixels, const idf::NdArray& as);

}  // namespace engram::augmentation
