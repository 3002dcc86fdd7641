// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>

#include "datasets/kitchen/kitchen_random.h"
#include "datasets/kitchen/textures.h"

namespace engram::datasets::kitchen {

namespace {

cv::Scalar scalar(const std::array<int, 3>& colour) {
  return {static_cast<double>(colour[0]), static_cast<double>(colour[1]),
          static_cast<double>(colour[2])};
}

/// Writes text, centred at the height `at_y`, so wide that it fills `share` of the face.
void write(cv::Mat& face, std::string_view text, double at_y, double share,
           const cv::Scalar& colour) {
  if (text.empty()) return;
  const std::string words(text);
  constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
  int base = 0;
  const cv::Size unit = cv::getTextSize(words, kFont, 1.0, 2, &base);
  const double scale = std::min(share * face.cols / unit.width, 0.30 * face.rows / unit.height);
  const int stroke = std::max(1, static_cast<int>(2.4 * scale));
  const cv::Size size = cv::getTextSize(words, kFont, scale, stroke, &base);
  cv::putText(face, words,
              {(face.cols - size.width) / 2, static_cast<int>(at_y * face.rows) + size.height / 2},
              kFont, scale, colour, stroke, cv::LINE_AA);
}

/// Draws lines that look like small print.
void write_small_print(cv::Mat& face, double from, double to, const cv::Scalar& colour,
                       Random& random) {
  const int step = std::max(3, face.rows / 22);
  for (int y = static_cast<int>(from * face.rows); y < to * face.rows; y += step)
    cv::line(face, {static_cast<int>(0.16 * face.cols), y},
             {static_cast<int>(random.between(0.5, 0.86) * face.cols), y}, colour,
             std::max(1, step / 3));
}

void paint_front(cv::Mat& face, const ThingClass& type) {
  const cv::Scalar accent = scalar(type.accent);
  const int side = face.cols;
  cv::rectangle(face, {0, 0}, {side, side / 9}, accent, cv::FILLED);
  cv::circle(face, {side / 2, side * 7 / 10}, side / 5, accent, cv::FILLED, cv::LINE_AA);
  cv::circle(face, {side / 2, side * 7 / 10}, side / 8, scalar(type.colour) * 0.8, cv::FILLED,
             cv::LINE_AA);
  write(face, type.label, 0.32, 0.82, accent);
}

void paint_band(cv::Mat& face, const ThingClass& type) {
  const cv::Scalar accent = scalar(type.accent);
  const int side = face.cols;
  cv::rectangle(face, {0, side * 26 / 100}, {side, side * 70 / 100}, accent, cv::FILLED);
  write(face, type.label, 0.48, 0.74, scalar(type.colour) * 0.75);
}

/// Distorts a face of a cube so that it looks straight on a cylinder, onto which OpenGL projects
/// the cube from the axis.
void wrap(cv::Mat& face) {
  const double half = 0.5 * (face.cols - 1);
  cv::Mat from_x(face.size(), CV_32FC1);
  cv::Mat from_y(face.size(), CV_32FC1);
  for (int y = 0; y < face.rows; ++y)
    for (int x = 0; x < face.cols; ++x) {
      const double across = (x - half) / half;
      from_x.at<float>(y, x) =
          static_cast<float>(half + half * std::atan(across) * 4 / std::numbers::pi);
      from_y.at<float>(y, x) =
          static_cast<float>(half + (y - half) / std::sqrt(1 + across * across));
    }
  cv::Mat wrapped;
  cv::remap(face, wrapped, from_x, from_y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  wrapped.copyTo(face);
}

void turn(cv::Mat& face, cv::RotateFlags how) {
  cv::Mat turned;
  cv::rotate(face, turned, how);
  turned.copyTo(face);
}

}  // namespace

cv::Mat paint_thing(const ThingClass& type, int side, uint64_t seed) {
  Random random(seed);
  cv::Mat faces(6 * side, side, CV_8UC3, scalar(type.colour));
  for (int i = 0; i < 6; ++i) {
    cv::Mat face = faces.rowRange(i * side, (i + 1) * side);
    const bool is_end = i >= 4;
    if (type.shape == Shape::kBox) {
      const bool is_broad = i == 2 || i == 3;
      if (is_broad) paint_front(face, type);
      if (!is_broad && !is_end) {
        write(face, type.label, 0.25, 0.7, scalar(type.accent));
        write_small_print(face, 0.42, 0.86, scalar(type.accent), random);
      }
    } else if (type.shape == Shape::kMug) {
      if (!is_end)
        cv::rectangle(face, {0, side * 60 / 100}, {side, side * 72 / 100}, scalar(type.accent),
                      cv::FILLED);
    } else if (!is_end) {
      paint_band(face, type);
    }
    if (is_end && type.shape == Shape::kCan) {
      face.setTo(cv::Scalar(188, 190, 192));
      cv::circle(face, {side / 2, side / 2}, side * 2 / 5, cv::Scalar(150, 152, 156), side / 40,
                 cv::LINE_AA);
    }
    if (type.shape != Shape::kBox && !is_end) wrap(face);
    // OpenGL orients some faces of a cube differently.
    if (i == 0) turn(face, cv::ROTATE_90_COUNTERCLOCKWISE);
    if (i == 1) turn(face, cv::ROTATE_90_CLOCKWISE);
    if (i == 2) turn(face, cv::ROTATE_180);
  }
  return faces;
}

}  // namespace engram::datasets::kitchen
