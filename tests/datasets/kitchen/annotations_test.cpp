// SPDX-License-Identifier: Apache-2.0
// What is recorded of objects and cameras is what is drawn.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "datasets/kitchen/entities.h"
#include "datasets/kitchen/kinematics.h"
#include "datasets/kitchen/kitchen_types.h"
#include "datasets/kitchen/reporter.h"
#include "datasets/kitchen/stance.h"

namespace engram::datasets::kitchen {
namespace {

constexpr DrawingSize kFull{};

/// Smallest and largest coordinates of something in an image.
struct Bounds {
  Eigen::Vector2d min{1e9, 1e9};
  Eigen::Vector2d max{-1e9, -1e9};

  void add(const Eigen::Vector2d& point) {
    min = min.cwiseMin(point);
    max = max.cwiseMax(point);
  }
  [[nodiscard]] bool is_inside() const {
    return min.x() > 2 && min.y() > 2 && max.x() < kFull.width - 3 && max.y() < kFull.height - 3;
  }
};

Bounds bounds_of(const idf::NdArray& mask) {
  Bounds bounds;
  const auto values = mask.values<uint8_t>();
  for (int y = 0; y < kFull.height; ++y)
    for (int x = 0; x < kFull.width; ++x)
      if (values[static_cast<size_t>(y * kFull.width + x)] != 0) bounds.add({x, y});
  return bounds;
}

class KitchenAnnotations : public ::testing::Test {
 protected:
  void SetUp() override {
    auto world = World::create(make_layout(3), kFull);
    ASSERT_TRUE(world.ok()) << world.status().to_string();
    world_ = std::make_unique<World>(std::move(world).value());
    auto renderer = Renderer::create(*world_, kFull);
    ASSERT_TRUE(renderer.ok()) << renderer.status().to_string();
    renderer_ = std::move(renderer).value();
  }

  /// Records one moment of the robot before a surface.
  void record(Surface surface) {
    RobotVector robot = resting_pose();
    robot.head<3>() = standing_at(slot_point(surface, 2), surface, 0.1);
    const auto [yaw, pitch] = Kinematics(*world_).look_at(robot, slot_point(surface, 2));
    robot[joint_index("neck_yaw")] = yaw;
    robot[joint_index("neck_pitch")] = pitch;
    world_->place_robot(robot);
    KitchenOptions options;
    options.records_depth = true;
    Reporter reporter(options, kFull, *world_, renderer_.get(), [&](const ltm::Commit& commit) {
      for (const ltm::EntityUpdate& update : commit.updates)
        recorded_[update.entity] = update.instances;
      return Status();
    });
    reporter.report_prior(world_->layout());
    ASSERT_TRUE(reporter.record(0).ok());
  }

  template <typename T>
  T value(const ltm::MemoryId& entity, size_t instance = 0) {
    return T::from_idf(recorded_.at(entity).at(instance).data).value();
  }

  std::unique_ptr<World> world_;
  std::unique_ptr<Renderer> renderer_;
  std::map<ltm::MemoryId, std::vector<ltm::Instance>> recorded_;
};

TEST_F(KitchenAnnotations, ProjectObjectsToWhereBothCamerasDrawThem) {
  int compared = 0;
  for (const Surface surface : {Surface::kCounter, Surface::kTable}) {
    record(surface);
    for (size_t i = 0; i < world_->layout().things.size(); ++i) {
      const ThingClass& type = *world_->layout().things[i].type;
      if (type.shape != Shape::kBox) continue;
      const auto object = value<::kitchen::ObjectInstance>(entities::object(type));
      const auto known = value<::kitchen::ObjectClass>(entities::object_class(type));
      const auto size = known.size.values<double>();
      const auto masks = renderer_->draw_mask(*world_, i);
      for (const size_t eye : {size_t{0}, size_t{1}}) {
        const auto view = value<::kitchen::View>(entities::stereo(), eye);
        const auto camera = value<::kitchen::CameraCalibration>(view.calibration.entity());
        Bounds projected;
        for (int corner = 0; corner < 8; ++corner) {
          const Eigen::Vector3d at((corner & 1 ? 0.5 : -0.5) * size[0],
                                   (corner & 2 ? 0.5 : -0.5) * size[1],
                                   (corner & 4 ? 0.5 : -0.5) * size[2]);
          const Eigen::Vector3d seen = view.pose_world_camera.isometry().inverse() *
                                       (object.pose_world_object.isometry() * at);
          if (seen.z() < 0.1) {
            projected.add({-1e6, -1e6});
            continue;
          }
          projected.add({camera.fx * seen.x() / seen.z() + camera.cx,
                         camera.fy * seen.y() / seen.z() + camera.cy});
        }
        if (!projected.is_inside()) continue;
        const Bounds drawn = bounds_of(eye == 0 ? masks.first : masks.second);
        EXPECT_LT((projected.min - drawn.min).cwiseAbs().maxCoeff(), 1.0) << type.name << eye;
        EXPECT_LT((projected.max - drawn.max).cwiseAbs().maxCoeff(), 1.0) << type.name << eye;
        ++compared;
      }
    }
  }
  EXPECT_GE(compared, 6);
}

TEST_F(KitchenAnnotations, DepthIsTheDistanceAlongTheAxisOfTheLeftCamera) {
  record(Surface::kTable);
  const auto depth = value<::kitchen::DepthView>(entities::depth());
  const auto view = value<::kitchen::View>(depth.view.entity(), 0);
  const auto camera = value<::kitchen::CameraCalibration>(view.calibration.entity());
  int compared = 0;
  for (const Thing& thing : world_->layout().things) {
    const auto object = value<::kitchen::ObjectInstance>(entities::object(*thing.type));
    if (thing.type->shape != Shape::kBox || !object.is_visible) continue;
    const Eigen::Vector3d seen =
        view.pose_world_camera.isometry().inverse() *
        (object.pose_world_object.isometry() * Eigen::Vector3d(0, 0, 0.5 * thing.type->size_m.z()));
    const int u = static_cast<int>(std::lround(camera.fx * seen.x() / seen.z() + camera.cx));
    const int v = static_cast<int>(std::lround(camera.fy * seen.y() / seen.z() + camera.cy));
    if (u < 0 || v < 0 || u >= kFull.width || v >= kFull.height) continue;
    EXPECT_NEAR(depth.depth.at<uint16_t>(v, u), 1000 * seen.z(), 4) << thing.type->name;
    ++compared;
  }
  EXPECT_GE(compared, 2);
}

TEST_F(KitchenAnnotations, CamerasAreBesideEachOther) {
  record(Surface::kCounter);
  const auto left = value<::kitchen::View>(entities::stereo(), 0);
  const auto right = value<::kitchen::View>(entities::stereo(), 1);
  const Eigen::Vector3d across =
      left.pose_world_camera.isometry().inverse() * right.pose_world_camera.position;
  EXPECT_NEAR((across - Eigen::Vector3d(kBaseline_m, 0, 0)).norm(), 0, 1e-9);
  const auto calibration = value<::kitchen::CameraCalibration>(entities::calibration("left"));
  const Pose again = world_->body_pose("head") * calibration.pose_head_camera.isometry();
  EXPECT_TRUE(again.isApprox(left.pose_world_camera.isometry(), 1e-9));
}

}  // namespace
}  // namespace engram::datasets::kitchen
