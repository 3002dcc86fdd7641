// SPDX-License-Identifier: Apache-2.0
#include "ltm/filter/reduced_image.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace engram::ltm {

namespace {

constexpr int64_t kLargestSide = 1 << 20;
constexpr int kWindow = 8;
constexpr int kStride = 4;

std::optional<int> depth_of(idf::ElementType type) {
  switch (type) {
    case idf::ElementType::kUInt8:
      return CV_8U;
    case idf::ElementType::kUInt16:
      return CV_16U;
    case idf::ElementType::kInt16:
      return CV_16S;
    case idf::ElementType::kFloat32:
      return CV_32F;
    case idf::ElementType::kFloat64:
      return CV_64F;
    default:
      return std::nullopt;
  }
}

bool is_image_shape(const idf::Shape& shape) {
  if (shape.size() != 2 && shape.size() != 3) return false;
  const bool has_channels = shape.size() == 2 || (shape[2] >= 1 && shape[2] <= 4);
  return has_channels && shape[0] >= 1 && shape[1] >= 1 && shape[0] <= kLargestSide &&
         shape[1] <= kLargestSide;
}

/// A view that shares the pixels; do not write to it.
cv::Mat view(const idf::NdArray& array, int depth) {
  const idf::Shape& shape = array.shape();
  const int channels = shape.size() == 3 ? static_cast<int>(shape[2]) : 1;
  return cv::Mat(static_cast<int>(shape[0]), static_cast<int>(shape[1]),
                 CV_MAKETYPE(depth, channels), const_cast<std::byte*>(array.buffer().data()));
}

/// A copy in which values that are not finite are 0. Integer images have none and are not copied.
cv::Mat finite(const cv::Mat& image) {
  if (image.depth() != CV_32F && image.depth() != CV_64F) return image;
  cv::Mat copy;
  image.convertTo(copy, CV_32F);
  for (int row = 0; row < copy.rows; ++row) {
    auto* values = copy.ptr<float>(row);
    std::replace_if(
        values, values + copy.cols * copy.channels(), [](float v) { return !std::isfinite(v); },
        0.0f);
  }
  return copy;
}

cv::Size reduced_size(const cv::Mat& image) {
  const int longest = std::max(image.cols, image.rows);
  if (longest <= ReducedImage::kLongestSide) return image.size();
  const auto side = [&](int length) {
    return std::max(1, static_cast<int>(int64_t{length} * ReducedImage::kLongestSide / longest));
  };
  return {side(image.cols), side(image.rows)};
}

double range_of(int depth, const std::vector<float>& pixels) {
  if (depth == CV_8U) return 255;
  if (depth == CV_16U || depth == CV_16S) return 65535;
  const auto [min, max] = std::ranges::minmax(pixels);
  return static_cast<double>(max) - static_cast<double>(min);
}

}  // namespace

std::optional<ReducedImage> ReducedImage::of(const idf::NdArray& array) {
  const auto depth = depth_of(array.type());
  if (!depth || !is_image_shape(array.shape())) return std::nullopt;
  try {
    const cv::Mat image = finite(view(array, *depth));
    cv::Mat small;
    cv::resize(image, small, reduced_size(image), 0, 0, cv::INTER_AREA);
    cv::Mat floats;
    small.convertTo(floats, CV_32F);
    ReducedImage reduced;
    reduced.height_ = floats.rows;
    reduced.width_ = floats.cols;
    reduced.channels_ = floats.channels();
    const auto* first = floats.ptr<float>();
    reduced.pixels_.assign(first, first + floats.total() * static_cast<size_t>(floats.channels()));
    reduced.range_ = range_of(*depth, reduced.pixels_);
    return reduced;
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
}

double ReducedImage::measured(Measure measure, const ReducedImage& other) const {
  ENGRAM_CHECK(height_ == other.height_ && width_ == other.width_ && channels_ == other.channels_,
               "images of {} x {} x {} and {} x {} x {}", height_, width_, channels_, other.height_,
               other.width_, other.channels_);
  ENGRAM_CHECK(is_image_measure(measure), "'{}' is no measure of images", to_string(measure));
  if (measure == Measure::kSsim) return ssim(other);
  double sum = 0;
  for (size_t i = 0; i < pixels_.size(); ++i) {
    const double apart = static_cast<double>(pixels_[i]) - static_cast<double>(other.pixels_[i]);
    sum += measure == Measure::kMse ? apart * apart : std::abs(apart);
  }
  return sum / static_cast<double>(pixels_.size());
}

double ReducedImage::ssim(const ReducedImage& other) const {
  const double range = std::max({range_, other.range_, std::numeric_limits<double>::min()});
  double sum = 0;
  int count = 0;
  for (int top = 0; top == 0 || top + kWindow <= height_; top += kStride)
    for (int left = 0; left == 0 || left + kWindow <= width_; left += kStride)
      for (int channel = 0; channel < channels_; ++channel, ++count)
        sum += ssim_of_window(other, top, left, channel, range);
  return sum / count;
}

// Wang et al., "Image Quality Assessment: From Error Visibility to Structural Similarity", 2004,
// equation 13, over square windows of equal weight.
double ReducedImage::ssim_of_window(const ReducedImage& other, int top, int left, int channel,
                                    double range) const {
  const int bottom = std::min(top + kWindow, height_);
  const int right = std::min(left + kWindow, width_);
  const double count = (bottom - top) * (right - left);
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) {
      const auto at = static_cast<size_t>((y * width_ + x) * channels_ + channel);
      const double p = static_cast<double>(pixels_[at]);
      const double q = static_cast<double>(other.pixels_[at]);
      a += p;
      b += q;
      aa += p * p;
      bb += q * q;
      ab += p * q;
    }
  const double mean_a = a / count, mean_b = b / count;
  const double var_a = aa / count - mean_a * mean_a, var_b = bb / count - mean_b * mean_b;
  const double covariance = ab / count - mean_a * mean_b;
  const double c1 = 0.01 * range * 0.01 * range, c2 = 0.03 * range * 0.03 * range;
  const double luminance = (2 * mean_a * mean_b + c1) / (mean_a * mean_a + mean_b * mean_b + c1);
  return luminance * (2 * covariance + c2) / (var_a + var_b + c2);
}

}  // namespace engram::ltm
