// SPDX-License-Identifier: Apache-2.0
#include "speech/sights/changed_images.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace engram::speech {

namespace {

/// Pixels of less saturation are grey: prints, metal, light.
constexpr double kMinSaturation = 0.2;
/// A pixel of a thing has its hue if it is at most so far from it. Unit: degrees.
constexpr double kMaxHueDistance = 30;
/// Light that differs by so much, of all and of each of red, green and blue.
constexpr double kLight = 0.15;
constexpr double kTint = 0.05;

double between(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// An image as a matrix that shares its pixels.
cv::Mat as_mat(const idf::NdArray& image) {
  return cv::Mat(static_cast<int>(image.shape()[0]), static_cast<int>(image.shape()[1]), CV_8UC3,
                 const_cast<std::byte*>(image.bytes().data()));
}

/// Hue in degrees, saturation and value from 0 to 1. Shape: float32 [H, W, 3].
cv::Mat hsv_of(const cv::Mat& rgb) {
  cv::Mat hsv;
  rgb.convertTo(hsv, CV_32FC3, 1.0 / 255);
  cv::cvtColor(hsv, hsv, cv::COLOR_RGB2HSV);
  return hsv;
}

double hue_distance(double a, double b) {
  const double distance = std::fmod(std::abs(a - b), 360);
  return std::min(distance, 360 - distance);
}

/// Calls `visit` with the colour of each pixel within an outline that is not grey.
template <typename Visit>
void visit_colours(cv::Mat& hsv, const std::vector<cv::Point2f>& outline, const Visit& visit) {
  const cv::Mat mask = mask_of(outline, hsv.size());
  for (int y = 0; y < hsv.rows; ++y)
    for (int x = 0; x < hsv.cols; ++x)
      if (auto& pixel = hsv.at<cv::Vec3f>(y, x);
          mask.at<uint8_t>(y, x) != 0 && pixel[1] >= kMinSaturation)
        visit(pixel, y, x);
}

void mirror(ImageTruth& truth, const CellGrid& grid, const std::vector<int64_t>& mirrored_where) {
  for (int row = 0; row < grid.rows; ++row) {
    const auto begin = truth.kinds.begin() + row * grid.columns;
    std::reverse(begin, begin + grid.columns);
  }
  for (TrueSight& thing : truth.things)
    thing.where = mirrored_where.at(static_cast<size_t>(thing.where));
}

}  // namespace

void ColourLooks::see(const idf::NdArray& image, const ImageTruth& truth) {
  cv::Mat pixels = hsv_of(as_mat(image));
  for (const TrueSight& thing : truth.things) {
    if (thing.colour < 0 || !thing.is_in_sight) continue;
    const auto colour = static_cast<size_t>(thing.colour);
    if (seen_.size() <= colour) seen_.resize(colour + 1);
    Seen& seen = seen_[colour];
    visit_colours(pixels, thing.outline, [&seen](const cv::Vec3f& hsv, int, int) {
      const auto bin = std::min(kHues - 1, static_cast<size_t>(hsv[0] / 360 * kHues));
      const double weight = hsv[1] * hsv[2];
      seen.weight.at(bin) += weight;
      seen.hue.at(bin) += weight * hsv[0];
      seen.saturation.at(bin) += weight * hsv[1];
      seen.value.at(bin) += weight * hsv[2];
    });
  }
}

Hsv ColourLooks::look(int64_t colour) const {
  if (colour < 0 || static_cast<size_t>(colour) >= seen_.size()) return {};
  const Seen& seen = seen_[static_cast<size_t>(colour)];
  const auto max = std::max_element(seen.weight.begin(), seen.weight.end());
  if (*max <= 0) return {};
  const auto bin = static_cast<size_t>(max - seen.weight.begin());
  return {seen.hue.at(bin) / *max, seen.saturation.at(bin) / *max, seen.value.at(bin) / *max};
}

ChangedImage change_image(const idf::NdArray& image, const ImageTruth& truth, const CellGrid& grid,
                          const ColourLooks& looks, const std::vector<int64_t>& mirrored_where,
                          std::mt19937_64& random) {
  cv::Mat pixels = as_mat(image).clone();
  cv::Mat hsv = hsv_of(pixels);
  cv::Mat is_other(pixels.size(), CV_8UC1, cv::Scalar(0));
  ImageTruth changed = truth;
  for (TrueSight& thing : changed.things) {
    const Hsv own = looks.look(thing.colour);
    if (own.saturation <= 0) continue;
    const auto colour = static_cast<int64_t>(random() % looks.colours());
    const Hsv other = looks.look(colour);
    if (other.saturation <= 0 || colour == thing.colour) continue;
    thing.colour = colour;
    visit_colours(hsv, thing.outline, [&](cv::Vec3f& pixel, int y, int x) {
      if (hue_distance(pixel[0], own.hue) > kMaxHueDistance) return;
      const double saturation = pixel[1] * other.saturation / own.saturation;
      const double value = pixel[2] * other.value / own.value;
      pixel = {static_cast<float>(other.hue), static_cast<float>(std::min(1.0, saturation)),
               static_cast<float>(std::min(1.0, value))};
      is_other.at<uint8_t>(y, x) = 255;
    });
  }
  cv::cvtColor(hsv, hsv, cv::COLOR_HSV2RGB);
  cv::Mat painted;
  hsv.convertTo(painted, CV_8UC3, 255);
  painted.copyTo(pixels, is_other);
  const double light = between(random, 1 - kLight, 1 + kLight);
  cv::Scalar gain;
  for (int c = 0; c < 3; ++c) gain[c] = light * between(random, 1 - kTint, 1 + kTint);
  cv::multiply(pixels, gain, pixels);
  if (random() % 2 == 1) {
    cv::flip(pixels, pixels, 1);
    mirror(changed, grid, mirrored_where);
  }
  std::vector<uint8_t> bytes(pixels.data, pixels.data + pixels.total() * pixels.elemSize());
  return {idf::NdArray::take(image.shape(), std::move(bytes)), std::move(changed)};
}

const idf::NdArray* image_in(const idf::Data& value) {
  const auto is_image = [](const idf::NdArray* array) {
    return array != nullptr && array->type() == idf::ElementType::kUInt8 &&
           array->shape().size() == 3 && array->shape()[2] == 3;
  };
  if (const auto* array = value.get_if<idf::NdArray>(); is_image(array)) return array;
  const auto* dict = value.get_if<idf::Dict>();
  if (dict == nullptr) return nullptr;
  for (const idf::DictEntry& member : *dict)
    if (const auto* array = member.value.get_if<idf::NdArray>(); is_image(array)) return array;
  return nullptr;
}

idf::Data with_image(const idf::Data& value, idf::NdArray image) {
  idf::Data changed = value;
  auto* dict = changed.get_if<idf::Dict>();
  if (dict == nullptr) return idf::Data(std::move(image));
  const idf::NdArray* old = image_in(changed);
  for (const idf::DictEntry& member : *dict)
    if (member.value.get_if<idf::NdArray>() == old) {
      dict->set(member.key, idf::Data(std::move(image)));
      break;
    }
  return changed;
}

}  // namespace engram::speech
