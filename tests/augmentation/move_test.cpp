// SPDX-License-Identifier: Apache-2.0
#include "augmentation/move.h"

#include <gtest/gtest.h>

#include <cmath>

namespace engram::augmentation {
namespace {

TEST(Move, KnowsSinesToAMillionth) {
  for (int64_t millidegrees = -45'000; millidegrees <= 45'000; millidegrees += 499) {
    const Move move = Move::turn(millidegrees);
    const double angle = static_cast<double>(millidegrees) * M_PI / 180'000;
    EXPECT_NEAR(static_cast<double>(move.cosine) / static_cast<double>(kUnit), std::cos(angle),
                1e-7);
    EXPECT_NEAR(static_cast<double>(move.sine) / static_cast<double>(kUnit), std::sin(angle), 1e-7);
  }
}

SceneImages dot_at(int x, int y) {
  SceneImages scene;
  scene.images.push_back({"image", PixelRole::kLight, cv::Mat::zeros(40, 60, CV_8UC1)});
  scene.images.front().pixels.at<uint8_t>(y, x) = 200;
  scene.points.push_back({"dot", {static_cast<double>(x), static_cast<double>(y)}});
  return scene;
}

TEST(Move, ShiftsByWholePixelsAndRepeatsTheEdge) {
  SceneImages scene = dot_at(0, 10);
  Move move;
  move.right_permille = 50;   // 3 of 60.
  move.down_permille = -100;  // 4 of 40.
  move.apply(scene);
  const cv::Mat& image = scene.images.front().pixels;
  for (int x = 0; x <= 3; ++x) EXPECT_EQ(image.at<uint8_t>(6, x), 200);
  EXPECT_EQ(image.at<uint8_t>(6, 4), 0);
  EXPECT_EQ(scene.points.front().coordinates, (std::vector<double>{3, 6}));
}

TEST(Move, TurnsClockwiseWithItsPoints) {
  SceneImages scene = dot_at(50, 20);
  Move::turn(30'000).apply(scene);
  const std::vector<double>& point = scene.points.front().coordinates;
  EXPECT_NEAR(point[0], 29.5 + 20.5 * std::cos(M_PI / 6) - 0.5 * std::sin(M_PI / 6), 1e-6);
  EXPECT_NEAR(point[1], 19.5 + 20.5 * std::sin(M_PI / 6) + 0.5 * std::cos(M_PI / 6), 1e-6);
  // The dot's light lies around its point.
  double sum = 0, x_sum = 0, y_sum = 0;
  const cv::Mat& image = scene.images.front().pixels;
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      sum += image.at<uint8_t>(y, x);
      x_sum += x * image.at<uint8_t>(y, x);
      y_sum += y * image.at<uint8_t>(y, x);
    }
  EXPECT_NEAR(sum, 200, 40);
  EXPECT_NEAR(x_sum / sum, point[0], 0.2);
  EXPECT_NEAR(y_sum / sum, point[1], 0.2);
}

TEST(Move, LeavesDepthAndLabelsWholeNumbersOfTheirOwn) {
  SceneImages scene;
  cv::Mat labels(30, 30, CV_8UC1, cv::Scalar(0));
  labels(cv::Rect(10, 10, 10, 10)) = 7;
  scene.images.push_back({"labels", PixelRole::kLabel, labels});
  scene.images.push_back({"depth", PixelRole::kDepth, cv::Mat(30, 30, CV_32FC1, cv::Scalar(1.5))});
  Move::turn(20'000).apply(scene);
  const cv::Mat& turned = scene.images[0].pixels;
  EXPECT_EQ(cv::countNonZero(turned == 7) + cv::countNonZero(turned == 0), 900);
  EXPECT_NEAR(cv::countNonZero(turned == 7), 100, 6);
  const cv::Mat& depth = scene.images[1].pixels;
  EXPECT_EQ(depth.at<float>(15, 15), 1.5f);
  EXPECT_EQ(depth.at<float>(0, 0), 0.0f);  // Nothing was seen there.
}

}  // namespace
}  // namespace engram::augmentation
