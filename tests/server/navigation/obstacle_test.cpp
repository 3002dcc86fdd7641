// SPDX-License-Identifier: Apache-2.0
#include "server/navigation/obstacle.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace engram::navigation {
namespace {

Obstacle box(double x, double y, double heading, double size_x, double size_y) {
  Obstacle obstacle;
  obstacle.pose_world_obstacle = {x, y, heading};
  obstacle.size_m = {size_x, size_y};
  return obstacle;
}

TEST(Obstacle, TellsTheDistanceOfPointsFromATurnedBox) {
  const Obstacle turned = box(1, 2, std::numbers::pi / 2, 2, 1);
  EXPECT_EQ(turned.distance_m({1, 2}), 0);
  EXPECT_NEAR(turned.distance_m({1, 4}), 1, 1e-12);
  EXPECT_NEAR(turned.distance_m({2, 2}), 0.5, 1e-12);
  EXPECT_NEAR(turned.distance_m({1.5 + 3, 3 + 4}), 5, 1e-12);
}

TEST(Obstacle, TellsTheDistanceOfPointsFromACylinder) {
  Obstacle post = box(0, 0, 0, 1, 1);
  post.shape = Obstacle::Shape::kCylinder;
  EXPECT_NEAR(post.distance_m({3, 4}), 4.5, 1e-12);
  EXPECT_EQ(post.distance_m({0.3, 0.3}), 0);
}

// Whatever touches a square has a point in it, so a dense net of points is a witness.
TEST(Obstacle, TouchesExactlyTheSquaresInWhichItHasPoints) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1, 1);
  std::uniform_real_distribution<double> size(0.05, 1);
  int touched = 0;
  for (int i = 0; i < 2000; ++i) {
    Obstacle obstacle =
        box(place(random), place(random), 3 * place(random), size(random), size(random));
    if (i % 2 == 0) {
      obstacle.shape = Obstacle::Shape::kCylinder;
      obstacle.size_m.y() = obstacle.size_m.x();
    }
    const PlanarPose square{place(random), place(random), 3 * place(random)};
    constexpr double kSide = 0.2;
    double nearest = 1e9;
    for (int x = 0; x <= 40; ++x)
      for (int y = 0; y <= 40; ++y)
        nearest = std::min(nearest, obstacle.distance_m(square.outward(
                                        {kSide * (x / 40.0 - 0.5), kSide * (y / 40.0 - 0.5)})));
    const bool touches = obstacle.touches_square(square.position(), kSide, square.heading_rad);
    if (nearest == 0) {
      EXPECT_TRUE(touches) << i;
    }
    if (nearest > kSide / 40) {
      EXPECT_FALSE(touches) << i << ": " << nearest;
    }
    touched += touches ? 1 : 0;
  }
  EXPECT_GT(touched, 200);
}

TEST(Obstacle, IsWhereItWasWithinAMillimetre) {
  const Obstacle before = box(1, 1, 0.5, 1, 2);
  EXPECT_TRUE(before.is_at(box(1.0005, 1, 0.5 + 2 * std::numbers::pi, 1, 2)));
  EXPECT_FALSE(before.is_at(box(1.002, 1, 0.5, 1, 2)));
  EXPECT_FALSE(before.is_at(box(1, 1, 0.51, 1, 2)));
  EXPECT_FALSE(before.is_at(box(1, 1, 0.5, 1, 2.1)));
}

}  // namespace
}  // namespace engram::navigation
