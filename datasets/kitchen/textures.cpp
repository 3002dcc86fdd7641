// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/textures.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "datasets/kitchen/kitchen_random.h"

namespace engram::datasets::kitchen {

namespace {

cv::Scalar rgb(double r, double g, double b) {
  return {r, g, b};
}

/// Returns smooth noise with mean 0 and about -1..1, CV_32FC1, with grains of `grain_x` by
/// `grain_y` pixels.
cv::Mat noise(int side, double grain_x, double grain_y, Random& random) {
  const int columns = std::max(2, static_cast<int>(std::ceil(side / grain_x)));
  const int rows = std::max(2, static_cast<int>(std::ceil(side / grain_y)));
  cv::Mat coarse(rows, columns, CV_32FC1);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      coarse.at<float>(y, x) = static_cast<float>(random.between(-1, 1));
  cv::Mat fine;
  cv::resize(coarse, fine, {side, side}, 0, 0, cv::INTER_CUBIC);
  return fine;
}

/// Adds `amount` grey levels times `grey` to all channels.
void add_grey(cv::Mat& image, const cv::Mat& grey, double amount) {
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        uint8_t& value = image.at<cv::Vec3b>(y, x)[c];
        value = cv::saturate_cast<uint8_t>(value + amount * grey.at<float>(y, x));
      }
}

cv::Scalar lighter(const cv::Scalar& colour, double by) {
  return {colour[0] + by, colour[1] + by, colour[2] + by};
}

}  // namespace

cv::Mat paint_wood(int side, int boards, double tone, uint64_t seed) {
  Random random(seed);
  cv::Mat image(side, side, CV_8UC3);
  const cv::Scalar base = lighter(rgb(158, 108, 64), 26 * tone);
  for (int i = 0; i < boards; ++i) {
    const int top = side * i / boards;
    const int bottom = side * (i + 1) / boards;
    const double shade = random.between(-14, 14);
    image.rowRange(top, bottom).setTo(lighter(base, shade));
  }
  // The rings run along the boards and are slightly bent.
  const cv::Mat bend = noise(side, side / 2.0, side / 12.0, random);
  cv::Mat rings(side, side, CV_32FC1);
  for (int y = 0; y < side; ++y) {
    const int board = y * boards / side;
    for (int x = 0; x < side; ++x)
      rings.at<float>(y, x) = static_cast<float>(
          std::sin(0.16 * 512 / side * y + 2.6 * board + 5.0 * bend.at<float>(y, x)));
  }
  add_grey(image, rings, 9);
  add_grey(image, noise(side, side / 6.0, 2, random), 9);
  for (int i = 0; i < boards && boards > 1; ++i)
    cv::line(image, {0, side * i / boards}, {side, side * i / boards}, base * 0.55, 1);
  return image;
}

cv::Mat paint_floor_tiles(int side, uint64_t seed) {
  Random random(seed);
  cv::Mat image(side, side, CV_8UC3, rgb(112, 104, 95));
  constexpr int kTiles = 4;
  const int joint = std::max(1, side / 128);
  for (int i = 0; i < kTiles; ++i)
    for (int j = 0; j < kTiles; ++j) {
      const bool is_dark = (i + j) % 2 == 1;
      const cv::Scalar colour =
          lighter(is_dark ? rgb(136, 108, 86) : rgb(184, 168, 146), random.between(-7, 7));
      cv::rectangle(image, {side * j / kTiles + joint, side * i / kTiles + joint},
                    {side * (j + 1) / kTiles - joint, side * (i + 1) / kTiles - joint}, colour,
                    cv::FILLED);
    }
  add_grey(image, noise(side, side / 24.0, side / 24.0, random), 7);
  return image;
}

cv::Mat paint_wall_tiles(int side, uint64_t seed) {
  Random random(seed);
  cv::Mat image(side, side, CV_8UC3, rgb(176, 178, 172));
  constexpr int kRows = 8;
  constexpr int kColumns = 4;
  const int joint = std::max(1, side / 200);
  const int width = side / kColumns;
  for (int i = 0; i < kRows; ++i)
    for (int j = -1; j <= kColumns; ++j) {
      const int left = j * width + (i % 2) * width / 2;
      const cv::Scalar colour = lighter(rgb(208, 222, 216), random.between(-9, 5));
      const cv::Point first{left + joint, side * i / kRows + joint};
      const cv::Point last{left + width - joint, side * (i + 1) / kRows - joint};
      cv::rectangle(image, first, last, colour, cv::FILLED);
      cv::line(image, first, {last.x, first.y}, lighter(colour, 14), joint);
    }
  return image;
}

cv::Mat paint_plaster(int side, cv::Scalar colour, uint64_t seed) {
  Random random(seed);
  cv::Mat image(side, side, CV_8UC3, colour);
  add_grey(image, noise(side, side / 8.0, side / 8.0, random), 4);
  add_grey(image, noise(side, 2, 2, random), 3);
  return image;
}

cv::Mat paint_stone(int side, uint64_t seed) {
  Random random(seed);
  cv::Mat image(side, side, CV_8UC3, rgb(96, 92, 90));
  add_grey(image, noise(side, 3, 3, random), 16);
  for (int i = 0; i < side; ++i) {
    const cv::Point at(static_cast<int>(random.below(static_cast<size_t>(side))),
                       static_cast<int>(random.below(static_cast<size_t>(side))));
    const double grey = random.between(50, 190);
    cv::circle(image, at, 1, rgb(grey, grey * 0.97, grey * 0.92), cv::FILLED, cv::LINE_AA);
  }
  return image;
}

cv::Mat paint_door(int side, cv::Scalar colour, uint64_t seed) {
  Random random(seed);
  cv::Mat image(side, side, CV_8UC3, colour);
  add_grey(image, noise(side, 3, side / 4.0, random), 4);
  const int edge = side / 40;
  const int frame = side / 7;
  cv::rectangle(image, {0, 0}, {side - 1, side - 1}, colour * 0.45, edge);
  cv::rectangle(image, {frame, frame}, {side - frame, side - frame}, colour * 0.72, edge);
  cv::line(image, {frame, side - frame}, {side - frame, side - frame}, lighter(colour, 22), edge);
  return image;
}

cv::Mat paint_garden(int side, uint64_t seed) {
  Random random(seed);
  cv::Mat image(side, side, CV_8UC3);
  const int horizon = side * 6 / 10;
  for (int y = 0; y < side; ++y) {
    const double down = static_cast<double>(y) / horizon;
    image.row(y).setTo(y < horizon ? rgb(150 + 70 * down, 196 + 34 * down, 238)
                                   : rgb(118, 158 - 20 * (down - 1), 84));
  }
  for (int i = 0; i < 26; ++i) {
    const int x = static_cast<int>(random.between(0, side));
    const int radius = static_cast<int>(random.between(side / 22.0, side / 9.0));
    const double shade = random.between(-16, 16);
    cv::circle(image, {x, horizon - radius / 3}, radius, rgb(78 + shade, 122 + shade, 66 + shade),
               cv::FILLED, cv::LINE_AA);
  }
  for (int i = 0; i < 9; ++i)
    cv::ellipse(image,
                {static_cast<int>(random.between(0, side)),
                 static_cast<int>(random.between(side * 0.08, side * 0.3))},
                {static_cast<int>(random.between(side / 16.0, side / 7.0)), side / 30}, 0, 0, 360,
                rgb(244, 247, 250), cv::FILLED, cv::LINE_AA);
  cv::GaussianBlur(image, image, {0, 0}, side / 100.0);
  return image;
}

cv::Mat paint_stove(int side) {
  cv::Mat image(side, side, CV_8UC3, rgb(24, 25, 28));
  const int line = std::max(1, side / 120);
  for (const auto& [x, y, radius] : {std::array{0.27, 0.30, 0.15}, std::array{0.73, 0.28, 0.19},
                                     std::array{0.28, 0.74, 0.19}, std::array{0.74, 0.74, 0.15}})
    for (const double part : {1.0, 0.62})
      cv::circle(image, {static_cast<int>(x * side), static_cast<int>(y * side)},
                 static_cast<int>(part * radius * side), rgb(150, 84, 70), line, cv::LINE_AA);
  cv::rectangle(image, {0, 0}, {side - 1, side - 1}, rgb(120, 122, 126), 2 * line);
  return image;
}

cv::Mat paint_cloth(int side, uint64_t seed) {
  Random random(seed);
  cv::Mat image(side, side, CV_8UC3, rgb(238, 232, 220));
  const int step = side / 8;
  for (int i = 0; i < side; i += step) {
    cv::Mat row = image.rowRange(i, std::min(side, i + step / 2));
    row -= cv::Scalar(22, 60, 66);
    cv::Mat column = image.colRange(i, std::min(side, i + step / 2));
    column -= cv::Scalar(22, 60, 66);
  }
  add_grey(image, noise(side, 2, 2, random), 8);
  return image;
}

cv::Mat paint_brushed_steel(int side, uint64_t seed) {
  Random random(seed);
  cv::Mat image(side, side, CV_8UC3, rgb(176, 178, 182));
  add_grey(image, noise(side, side / 2.0, 1.5, random), 12);
  return image;
}

}  // namespace engram::datasets::kitchen
