// SPDX-License-Identifier: Apache-2.0
#include "ltm/prediction/products.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace engram::ltm {
namespace {

TEST(Products, AreThoseOfTheMatrices) {
  std::srand(3);  // Of Eigen's random numbers.
  const Eigen::MatrixXd x = Eigen::MatrixXd::Random(57, 23), y = Eigen::MatrixXd::Random(57, 9);
  EXPECT_TRUE(squared(x).isApprox(x.transpose() * x, 1e-12));
  EXPECT_EQ(squared(x), squared(x).transpose());
  EXPECT_TRUE(product(x, y).isApprox(x.transpose() * y, 1e-12));
}

TEST(Products, OfNoRowsAreZero) {
  const Eigen::MatrixXd x(0, 3), y(0, 2);
  EXPECT_EQ(squared(x), Eigen::MatrixXd::Zero(3, 3));
  EXPECT_EQ(product(x, y), Eigen::MatrixXd::Zero(3, 2));
  EXPECT_EQ(product(x, Eigen::MatrixXd(0, 0)).size(), 0);
}

}  // namespace
}  // namespace engram::ltm
