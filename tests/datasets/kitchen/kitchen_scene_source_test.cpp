// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kitchen_scene_source.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "datasets/kitchen/kitchen.h"
#include "datasets/kitchen/kitchen_types.h"
#include "ltm/recording/recorder.h"
#include "ltm/typed/image.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

using ::kitchen::View;

/// A short recording in a store.
class KitchenSceneSourceTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = std::make_unique<ScratchDirectory>();
    KitchenOptions options = KitchenOptions::fast();
    options.seconds = 12;
    options.width = options.height = 32;
    auto recorder = ltm::Recorder::open(*scratch_ / "kitchen", {});
    ASSERT_OK(recorder);
    for (const auto& [segment, type] : kitchen_types()) ASSERT_OK(recorder->declare(segment, type));
    ASSERT_OK(simulate_kitchen(
        options, [&](const ltm::Commit& commit) { return recorder->commit(commit); }, {}));
    ASSERT_OK(recorder->close());
  }
  static void TearDownTestSuite() { scratch_.reset(); }

  void SetUp() override {
    auto store = ltm::StoreReader::open(*scratch_ / "kitchen");
    ASSERT_OK(store);
    store_ = *std::move(store);
    const auto index = store_->index(stereo_);
    ASSERT_OK(index);
    views_ = **index;
    ASSERT_EQ(views_.size(), 240u);
  }

  ltm::Snapshot view(size_t index) const { return *store_->read_recorded(stereo_, views_[index]); }

  static std::unique_ptr<ScratchDirectory> scratch_;
  const ltm::MemoryId stereo_ = *ltm::MemoryId::parse("Vision/RGB/head/stereo");
  std::unique_ptr<ltm::StoreReader> store_;
  std::vector<ltm::SnapshotEntry> views_;
  KitchenSceneSource source_;
};

std::unique_ptr<ScratchDirectory> KitchenSceneSourceTest::scratch_;

TEST_F(KitchenSceneSourceTest, RebuildsEveryMomentAtWhichObjectsWereRecorded) {
  // Objects are recorded five times a second, views twenty times.
  size_t whole = 0;
  for (size_t i = 0; i < views_.size(); i += 4) {
    const auto scene = source_.scene(*store_, view(i), 0);
    ASSERT_OK(scene);
    ASSERT_TRUE(scene->has_value()) << i;
    EXPECT_OK((*scene)->scene.validate());
    ++whole;
  }
  EXPECT_EQ(whole, 60u);
}

TEST_F(KitchenSceneSourceTest, LeavesOutMomentsBetweenWhereThingsMoved) {
  size_t known = 0;
  size_t unknown = 0;
  for (size_t i = 0; i < views_.size(); ++i) {
    const ltm::Snapshot snapshot = view(i);
    const auto scene = source_.scene(*store_, snapshot, 1);
    ASSERT_OK(scene);
    ++(scene->has_value() ? known : unknown);
  }
  // Most of the time nothing is held; while something is, three views of four are unknown.
  EXPECT_GT(known, 60u);
  EXPECT_GT(unknown, 0u);
}

TEST_F(KitchenSceneSourceTest, KnowsBothEyesAndWhatIsInSight) {
  const ltm::Snapshot snapshot = view(0);
  const auto left = source_.scene(*store_, snapshot, 0);
  const auto right = source_.scene(*store_, snapshot, 1);
  ASSERT_OK(left);
  ASSERT_OK(right);
  const auto& a = (*left)->scene.camera.pose;
  const auto& b = (*right)->scene.camera.pose;
  EXPECT_NEAR(std::hypot(a[3] - b[3], a[7] - b[7], a[11] - b[11]), 0.07, 1e-6);
  const size_t in_sight = (*left)->things_in_sight.size();
  EXPECT_LE(in_sight, 10u);
  bool sees_something = in_sight > 0;
  for (size_t i = 0; i < views_.size() && !sees_something; i += 4)
    sees_something = !(**source_.scene(*store_, view(i), 0)).things_in_sight.empty();
  EXPECT_TRUE(sees_something);
}

TEST_F(KitchenSceneSourceTest, WritesTheNewImageAndWhereItsCameraWas) {
  const ltm::Snapshot snapshot = view(0);
  const auto remembered = source_.scene(*store_, snapshot, 0);
  ASSERT_OK(remembered);
  augmentation::SceneCamera camera = (*remembered)->scene.camera;
  const auto before = View::from_idf(snapshot.instances[0].data);
  ASSERT_OK(before);
  camera.pose[11] += 0.25;
  const cv::Mat black = cv::Mat::zeros(32, 32, CV_8UC3);
  const auto value = source_.seen(snapshot.instances[0].data, camera,
                                  *typed::array_of(black, idf::PixelType::kRgb24));
  ASSERT_OK(value);
  const auto after = View::from_idf(*value);
  ASSERT_OK(after);
  EXPECT_EQ(cv::sum(after->image), cv::Scalar());
  EXPECT_EQ(after->joints, before->joints);
  const Eigen::Vector3d moved =
      after->pose_world_camera.position - before->pose_world_camera.position;
  EXPECT_TRUE(moved.isApprox(Eigen::Vector3d(0, 0, 0.25), 1e-9));
  EXPECT_LT(after->pose_world_camera.orientation.normalized().angularDistance(
                before->pose_world_camera.orientation.normalized()),
            1e-6);
}

TEST_F(KitchenSceneSourceTest, LeavesOtherRecordingsToOthers) {
  const ltm::MemoryId joints = *ltm::MemoryId::parse("RobotState/Proprioception/robot/joints");
  const auto index = store_->index(joints);
  ASSERT_OK(index);
  const auto scene = source_.scene(*store_, *store_->read_recorded(joints, (**index).front()), 0);
  ASSERT_OK(scene);
  EXPECT_FALSE(scene->has_value());
}

/// Counts the views of a second that are rebuilt, with a chair whose middle is at `x_m`.
size_t rebuilt_with_chair(double x_m) {
  const ScratchDirectory scratch;
  KitchenOptions options = KitchenOptions::fast();
  options.seconds = 1;
  options.width = options.height = 32;
  auto recorder = ltm::Recorder::open(scratch / "kitchen", {});
  EXPECT_OK(recorder);
  for (const auto& [segment, type] : kitchen_types()) EXPECT_OK(recorder->declare(segment, type));
  const auto with_chair = [&](ltm::Commit commit) {
    for (ltm::EntityUpdate update : std::vector(commit.updates)) {
      if (update.entity.names()[1] != "Instances") continue;
      auto chair = ::kitchen::ObjectInstance::from_idf(update.instances[0].data);
      EXPECT_OK(chair);
      chair->pose_world_object.position = {x_m, 0, 0.45};
      update.entity = *ltm::MemoryId::parse("Objects/Instances/kitchen/chair_1");
      update.instances[0].data = chair->to_idf();
      commit.updates.push_back(std::move(update));
      break;
    }
    return recorder->commit(commit);
  };
  EXPECT_OK(simulate_kitchen(options, with_chair, {}));
  EXPECT_OK(recorder->close());
  auto store = ltm::StoreReader::open(scratch / "kitchen");
  EXPECT_OK(store);
  const ltm::MemoryId stereo = *ltm::MemoryId::parse("Vision/RGB/head/stereo");
  const auto views = (*store)->index(stereo);
  EXPECT_OK(views);
  KitchenSceneSource source;
  size_t rebuilt = 0;
  for (const ltm::SnapshotEntry& entry : **views) {
    const auto scene = source.scene(**store, *(*store)->read_recorded(stereo, entry), 0);
    EXPECT_OK(scene);
    if (scene.ok() && *scene) ++rebuilt;
  }
  return rebuilt;
}

TEST(KitchenSceneSourceWithAChair, LeavesOutMomentsAtWhichItWasInTheRoom) {
  EXPECT_EQ(rebuilt_with_chair(0.6), 0u);
  EXPECT_GE(rebuilt_with_chair(6.0), 5u) << "outside";
}

}  // namespace
}  // namespace engram::datasets
