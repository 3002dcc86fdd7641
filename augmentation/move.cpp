// SPDX-License-Identifier: Apache-2.0
#include "augmentation/move.h"

#include <algorithm>
#include <cstring>

#include "augmentation/light.h"

namespace engram::augmentation {

namespace {

/// Number of bits for the fraction of a pixel in interpolation. Unit: 2^-8.
constexpr int kFractionBits = 8;
constexpr int64_t kFractions = 1 << kFractionBits;

constexpr int64_t times(int64_t a, int64_t b) {
  return (a * b + kUnit / 2) >> 30;
}

/// The number of pixels that a permille of a side corresponds to.
constexpr int64_t pixels_of(int64_t permille, int side) {
  return divided(permille * side, 1000);
}

/// The place in the source image that a pixel is taken from. Unit: 2^-8 pixels.
struct Place {
  int64_t x = 0;
  int64_t y = 0;
};

/// Computes the source places for one image.
class Origin {
 public:
  Origin(const Move& move, cv::Size size)
      : move_(move),
        middle_x_(size.width - 1),
        middle_y_(size.height - 1),
        right_(pixels_of(move.right_permille, size.width)),
        down_(pixels_of(move.down_permille, size.height)) {}

  /// Applies the inverse rotation. Coordinates are half pixels from the middle, so that no fraction
  /// is lost.
  [[nodiscard]] Place of(int x, int y) const {
    const int64_t u = 2 * (x - right_) - middle_x_;
    const int64_t v = 2 * (y - down_) - middle_y_;
    const int64_t from_x = u * move_.cosine + v * move_.sine + middle_x_ * kUnit;
    const int64_t from_y = v * move_.cosine - u * move_.sine + middle_y_ * kUnit;
    return {rounded(from_x), rounded(from_y)};
  }

 private:
  /// Converts from 2^-31 pixels to 2^-8 pixels.
  static int64_t rounded(int64_t value) {
    constexpr int kBits = 31 - kFractionBits;
    return (value + (int64_t{1} << (kBits - 1))) >> kBits;
  }

  const Move& move_;
  int64_t middle_x_, middle_y_;  ///< Unit: half pixels.
  int64_t right_, down_;         ///< Unit: pixels.
};

/// Interpolates between the four pixels around a place; beyond the edge, the edge repeats.
void interpolate(const cv::Mat& from, const Place& place, uint8_t* to) {
  const int64_t x = place.x >> kFractionBits;
  const int64_t y = place.y >> kFractionBits;
  const int64_t right = place.x & (kFractions - 1);
  const int64_t down = place.y & (kFractions - 1);
  const auto column = [&](int64_t at) {
    return static_cast<int>(std::clamp<int64_t>(at, 0, from.cols - 1)) * from.channels();
  };
  const auto row = [&](int64_t at) {
    return from.ptr<uint8_t>(static_cast<int>(std::clamp<int64_t>(at, 0, from.rows - 1)));
  };
  const int left_column = column(x), right_column = column(x + 1);
  const uint8_t* upper = row(y);
  const uint8_t* lower = row(y + 1);
  for (int c = 0; c < from.channels(); ++c) {
    const int64_t above =
        upper[left_column + c] * (kFractions - right) + upper[right_column + c] * right;
    const int64_t below =
        lower[left_column + c] * (kFractions - right) + lower[right_column + c] * right;
    const int64_t sum = above * (kFractions - down) + below * down;
    to[c] = static_cast<uint8_t>((sum + kFractions * kFractions / 2) >> (2 * kFractionBits));
  }
}

/// Takes the nearest pixel; beyond the edge, the result is zero.
void take_nearest(const cv::Mat& from, const Place& place, uint8_t* to) {
  const int64_t x = (place.x + kFractions / 2) >> kFractionBits;
  const int64_t y = (place.y + kFractions / 2) >> kFractionBits;
  const size_t bytes = from.elemSize();
  if (x < 0 || y < 0 || x >= from.cols || y >= from.rows)
    std::memset(to, 0, bytes);
  else
    std::memcpy(to, from.ptr<uint8_t>(static_cast<int>(y)) + static_cast<size_t>(x) * bytes, bytes);
}

cv::Mat moved(const Move& move, const cv::Mat& from, PixelRole role) {
  cv::Mat to(from.size(), from.type());
  const Origin origin(move, from.size());
  for (int y = 0; y < to.rows; ++y)
    for (int x = 0; x < to.cols; ++x) {
      uint8_t* pixel = to.ptr<uint8_t>(y) + static_cast<size_t>(x) * to.elemSize();
      if (role == PixelRole::kLight)
        interpolate(from, origin.of(x, y), pixel);
      else
        take_nearest(from, origin.of(x, y), pixel);
    }
  return to;
}

void move_points(const Move& move, cv::Size size, std::vector<double>& points) {
  const double middle_x = (size.width - 1) / 2.0;
  const double middle_y = (size.height - 1) / 2.0;
  const double cosine = static_cast<double>(move.cosine) / static_cast<double>(kUnit);
  const double sine = static_cast<double>(move.sine) / static_cast<double>(kUnit);
  const auto right = static_cast<double>(pixels_of(move.right_permille, size.width));
  const auto down = static_cast<double>(pixels_of(move.down_permille, size.height));
  for (size_t i = 0; i + 1 < points.size(); i += 2) {
    const double u = points[i] - middle_x;
    const double v = points[i + 1] - middle_y;
    points[i] = u * cosine - v * sine + middle_x + right;
    points[i + 1] = v * cosine + u * sine + middle_y + down;
  }
}

}  // namespace

Move Move::turn(int64_t millidegrees) {
  // The factor is pi / 180000 in units of 2^-30, times a million. Up to 45 degrees, six terms of
  // the series are exact.
  const int64_t angle = divided(millidegrees * 18'740'330'145, 1'000'000);
  const int64_t square = times(angle, angle);
  Move move;
  int64_t term = kUnit;
  move.cosine = move.sine = 0;
  for (int64_t n = 0; n <= 10; n += 2) {
    move.cosine += term;
    const int64_t odd = divided(times(term, angle), n + 1);
    move.sine += odd;
    term = divided(-times(term, square), (n + 1) * (n + 2));
  }
  return move;
}

void Move::apply(SceneImages& images) const {
  if (!images.images.empty())
    for (ScenePoints& points : images.points)
      move_points(*this, images.images.front().pixels.size(), points.coordinates);
  for (SceneImage& image : images.images) image.pixels = moved(*this, image.pixels, image.role);
  if (!images.labels.empty()) images.labels = moved(*this, images.labels, PixelRole::kLabel);
}

}  // namespace engram::augmentation
