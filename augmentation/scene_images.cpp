// SPDX-License-Identifier: Apache-2.0
#include "augmentation/scene_images.h"

#include <algorithm>
#include <cstring>
#include <opencv2/imgproc.hpp>

namespace engram::augmentation {

namespace {

/// Returns OpenCV's depth of an element type, or -1 if images cannot have that type.
int depth_of(idf::ElementType type) {
  switch (type) {
    case idf::ElementType::kUInt8:
      return CV_8U;
    case idf::ElementType::kUInt16:
      return CV_16U;
    case idf::ElementType::kFloat32:
      return CV_32F;
    default:
      return -1;
  }
}

}  // namespace

cv::Mat SceneImages::mask_of(int64_t label, cv::Size size) const {
  cv::Mat found = labels;
  for (const SceneImage& image : images)
    if (found.empty() && image.role == PixelRole::kLabel) found = image.pixels;
  if (found.empty()) return {};
  cv::Mat mask = label == 0 ? cv::Mat(found != 0) : cv::Mat(found == static_cast<double>(label));
  if (mask.size() != size) cv::resize(mask, mask, size, 0, 0, cv::INTER_NEAREST);
  return mask;
}

Result<cv::Mat> to_mat(const idf::NdArray& array) {
  const idf::Shape& shape = array.shape();
  const int depth = depth_of(array.type());
  constexpr int64_t kMaxSide = 1 << 15;
  const bool is_flat = shape.size() == 2;
  if (depth < 0 || (shape.size() != 3 && !is_flat) || shape[0] < 1 || shape[1] < 1 ||
      shape[0] > kMaxSide || shape[1] > kMaxSide ||
      (!is_flat && shape[2] != 1 && (shape[2] != 3 || depth != CV_8U)))
    return invalid_argument(
        "found {} {}, needs an image: uint8 [H, W, 3], or uint8, uint16 or "
        "float32 [H, W, 1]",
        to_string(array.type()), idf::to_string(shape));
  cv::Mat pixels(static_cast<int>(shape[0]), static_cast<int>(shape[1]),
                 CV_MAKETYPE(depth, is_flat ? 1 : static_cast<int>(shape[2])));
  std::memcpy(pixels.data, array.bytes().data(), array.bytes().size());
  return pixels;
}

idf::NdArray to_array(const cv::Mat& pixels, const idf::NdArray& as) {
  const cv::Mat whole = pixels.isContinuous() ? pixels : pixels.clone();
  const auto* bytes = reinterpret_cast<const std::byte*>(whole.data);
  auto array = idf::NdArray::create(as.type(), as.shape(),
                                    Buffer::copy({bytes, whole.total() * whole.elemSize()}));
  ENGRAM_CHECK(array.ok(), "{}", array.status().message());
  return *std::move(array);
}

}  // namespace engram::augmentation
