// SPDX-License-Identifier: Apache-2.0
#include "ltm/typed/pose.h"

#include <gtest/gtest.h>

#include "ltm/typed/convert_eigen.h"

namespace engram::typed {
namespace {

Pose<double> turned() {
  return {{1, 2, 3}, Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()))};
}

TEST(Pose, MovesPointsAsItsIsometryDoes) {
  const Pose<double> pose = turned();
  const Eigen::Vector3d point(4, 5, 6);
  const Eigen::Vector3d moved = pose.orientation * point + pose.position;
  EXPECT_TRUE((pose.isometry() * point).isApprox(moved, 1e-12));
  const Pose<double> again(pose.isometry());
  EXPECT_TRUE(again.position.isApprox(pose.position, 1e-12));
  EXPECT_TRUE(again.orientation.isApprox(pose.orientation, 1e-12));
}

TEST(Pose, StandsAsPositionAndOrientationInAValue) {
  const idf::Type type = idf::Type::pose(idf::ElementType::kFloat64);
  const idf::Data data = write(turned(), type);
  EXPECT_EQ(data.at("position")->get<idf::NdArray>().values<double>()[2], 3.0);
  const auto wxyz = data.at("orientation")->get<idf::NdArray>().values<double>();
  EXPECT_EQ(wxyz[0], turned().orientation.w());
  EXPECT_EQ(wxyz[3], turned().orientation.z());
  Pose<double> read_back;
  ASSERT_TRUE(read(data, type, read_back));
  EXPECT_TRUE(equal(read_back, turned()));
}

}  // namespace
}  // namespace engram::typed
