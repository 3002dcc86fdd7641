// SPDX-License-Identifier: Apache-2.0
#include "encoders/flow_extrapolation.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace engram::encoders {

namespace {

/// Min side of an image. Smaller images get no flow, because OpenCV accepts none below 12 pixels.
constexpr int kMinSide = 16;
/// Weight of a pixel that does not move, relative to the squared speed of others.
constexpr float kStillWeight = 0.01F;
/// Min covered share of a pixel. A pixel with less keeps its value.
constexpr float kMinCoverage = 0.5F;

/// A view that shares the pixels with `image` and is only read.
cv::Mat view(const idf::NdArray& image) {
  const int depth = image.type() == idf::ElementType::kUInt8 ? CV_8U : CV_16U;
  const int channels = image.rank() == 3 ? static_cast<int>(image.shape()[2]) : 1;
  return cv::Mat(static_cast<int>(image.shape()[0]), static_cast<int>(image.shape()[1]),
                 CV_MAKETYPE(depth, channels), const_cast<std::byte*>(image.bytes().data()));
}

/// Converts to the input of the flow: 8 bits and one channel. `scale` converts to grey levels.
cv::Mat grey(const cv::Mat& image, double scale) {
  cv::Mat one;
  if (image.channels() == 3)
    cv::cvtColor(image, one, cv::COLOR_RGB2GRAY);
  else
    cv::extractChannel(image, one, 0);
  cv::Mat result;
  one.convertTo(result, CV_8U, scale);
  return result;
}

double largest_of(const cv::Mat& image) {
  double largest = 0;
  cv::minMaxLoc(image.reshape(1), nullptr, &largest);
  return largest;
}

/// Displacement of each pixel of `last` since `before`. Shape: [H, W, 2]. Unit: pixels.
cv::Mat motion_of(const cv::Mat& before, const cv::Mat& last) {
  cv::Mat flow = cv::Mat::zeros(last.size(), CV_32FC2);
  if (std::min(last.rows, last.cols) < kMinSide) return flow;
  double scale = 1;
  if (last.depth() == CV_16U) scale = 255.0 / std::max({largest_of(before), largest_of(last), 1.0});
  const auto search = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
  search->setFinestScale(0);
  search->calc(grey(last, scale), grey(before, scale), flow);
  return -flow;
}

/// Sums of the pixels that arrive at each pixel of an image.
class Arrivals {
 public:
  explicit Arrivals(const cv::Mat& image)
      : channels_(image.channels()),
        sums_(cv::Mat::zeros(image.size(), CV_32FC(image.channels()))),
        weights_(cv::Mat::zeros(image.size(), CV_32F)),
        coverage_(cv::Mat::zeros(image.size(), CV_32F)) {}

  /// Distributes an arriving pixel to its four neighbours.
  void add(const float* pixel, float x, float y, float importance) {
    const int left = static_cast<int>(std::floor(x));
    const int top = static_cast<int>(std::floor(y));
    const float right_share = x - static_cast<float>(left);
    const float low_share = y - static_cast<float>(top);
    add_to(pixel, left, top, (1 - right_share) * (1 - low_share), importance);
    add_to(pixel, left + 1, top, right_share * (1 - low_share), importance);
    add_to(pixel, left, top + 1, (1 - right_share) * low_share, importance);
    add_to(pixel, left + 1, top + 1, right_share * low_share, importance);
  }

  /// Writes the arrived pixels over `image`, which holds floats.
  void put_over(cv::Mat& image) const {
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x) {
        if (coverage_.at<float>(y, x) < kMinCoverage) continue;
        const float* sum = sums_.ptr<float>(y) + x * channels_;
        float* pixel = image.ptr<float>(y) + x * channels_;
        for (int c = 0; c < channels_; ++c) pixel[c] = sum[c] / weights_.at<float>(y, x);
      }
  }

 private:
  void add_to(const float* pixel, int x, int y, float share, float importance) {
    if (x < 0 || y < 0 || x >= sums_.cols || y >= sums_.rows) return;
    float* sum = sums_.ptr<float>(y) + x * channels_;
    for (int c = 0; c < channels_; ++c) sum[c] += share * importance * pixel[c];
    weights_.at<float>(y, x) += share * importance;
    coverage_.at<float>(y, x) += share;
  }

  int channels_;
  cv::Mat sums_, weights_, coverage_;
};

cv::Mat moved(const cv::Mat& image, const cv::Mat& motion, float steps) {
  cv::Mat result;
  image.convertTo(result, CV_32F);
  const cv::Mat pixels = result.clone();
  Arrivals arrivals(pixels);
  for (int y = 0; y < pixels.rows; ++y)
    for (int x = 0; x < pixels.cols; ++x) {
      const auto& v = motion.at<cv::Vec2f>(y, x);
      // The flow of hostile pixels may have any value. Such pixels lie far outside and are skipped.
      if (!(std::abs(v[0]) < 1e4F && std::abs(v[1]) < 1e4F)) continue;
      arrivals.add(pixels.ptr<float>(y) + x * pixels.channels(),
                   static_cast<float>(x) + steps * v[0], static_cast<float>(y) + steps * v[1],
                   kStillWeight + v.dot(v));
    }
  arrivals.put_over(result);
  cv::Mat rounded;
  result.convertTo(rounded, image.depth());
  return rounded;
}

template <typename T>
idf::NdArray to_array(const cv::Mat& image, const idf::Shape& shape) {
  const T* first = image.ptr<T>();
  return idf::NdArray::take<T>(
      shape, std::vector<T>(first, first + image.total() * static_cast<size_t>(image.channels())));
}

Status check(const idf::NdArray& before, const idf::NdArray& last) {
  const bool has_type =
      last.type() == idf::ElementType::kUInt8 || last.type() == idf::ElementType::kUInt16;
  const idf::Shape& shape = last.shape();
  const bool has_channels = shape.size() == 3 && shape[2] >= 1 && shape[2] <= 4;
  const bool has_shape = (shape.size() == 2 || has_channels) && last.count() > 0;
  if (has_type && has_shape && before.type() == last.type() && before.shape() == shape) return {};
  return invalid_argument(
      "flow: found images {} {} and {} {}, needs two alike of uint8 or uint16, [H, W, 1 to 4]",
      idf::to_string(before.type()), idf::to_string(before.shape()), idf::to_string(last.type()),
      idf::to_string(shape));
}

}  // namespace

Result<std::vector<idf::NdArray>> flow_extrapolated(const idf::NdArray& before,
                                                    const idf::NdArray& last, int steps) {
  ENGRAM_RETURN_IF_ERROR(check(before, last));
  try {
    const cv::Mat image = view(last);
    const cv::Mat motion = motion_of(view(before), image);
    std::vector<idf::NdArray> images;
    for (int step = 1; step <= steps; ++step) {
      const cv::Mat next = moved(image, motion, static_cast<float>(step));
      images.push_back(image.depth() == CV_8U ? to_array<uint8_t>(next, last.shape())
                                              : to_array<uint16_t>(next, last.shape()));
    }
    return images;
  } catch (const cv::Exception& error) {
    return unavailable("flow: OpenCV: {}", error.what());
  }
}

}  // namespace engram::encoders
