// SPDX-License-Identifier: Apache-2.0
#include "datasets/kitchen/kitchen_scene.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "augmentation/blender/blender.h"
#include "datasets/kitchen/kitchen.h"
#include "datasets/kitchen/kitchen_types.h"
#include "ltm/typed/image.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets {
namespace {

using ::testing::HasSubstr;

/// The last moment of a short recording at which objects were seen.
class KitchenSceneTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    KitchenOptions options = KitchenOptions::fast();
    options.seconds = 6;
    std::map<std::string, idf::Data> last;
    const auto take = [&](const ltm::Commit& commit) -> Status {
      bool has_objects = false;
      for (const ltm::EntityUpdate& update : commit.updates) {
        last[update.entity.to_string()] = update.instances[0].data;
        has_objects |= update.entity.to_string().starts_with("Objects/Instances/");
      }
      if (!has_objects) return {};
      moment_.recording = last.at("Simulation/Recording/kitchen/options");
      moment_.calibration = last.at("Vision/Calibration/head/left");
      moment_.view = last.at("Vision/RGB/head/stereo");
      moment_.joints = last.at("RobotState/Proprioception/robot/joints");
      moment_.platform = last.at("RobotState/Localization/robot/platform");
      moment_.objects.clear();
      for (const auto& [entity, value] : last)
        if (entity.starts_with("Objects/Instances/"))
          moment_.objects.emplace_back(*ltm::MemoryId::parse(entity), value);
      return {};
    };
    ASSERT_OK(simulate_kitchen(options, take, {}));
  }

  static KitchenMoment moment_;
};

KitchenMoment KitchenSceneTest::moment_;

TEST_F(KitchenSceneTest, PutsThingsWhereTheyWere) {
  KitchenScenes scenes;
  const auto scene = scenes.scene(moment_);
  ASSERT_OK(scene);
  ASSERT_OK(scene->validate());
  ASSERT_GE(moment_.objects.size(), 7u);
  for (const auto& [entity, value] : moment_.objects) {
    const auto object = kitchen::ObjectInstance::from_idf(value);
    ASSERT_OK(object);
    // Its parts are around its middle.
    double nearest = 1e9;
    for (const augmentation::SceneShape& shape : scene->shapes) {
      if (shape.thing != entity.names().back()) continue;
      const Eigen::Vector3d at(shape.pose[3], shape.pose[7], shape.pose[11]);
      nearest = std::min(nearest, (at - object->pose_world_object.position).norm());
    }
    EXPECT_LT(nearest, 0.06) << entity.to_string();
  }
}

TEST_F(KitchenSceneTest, SaysWhatItDoesNotKnow) {
  KitchenScenes scenes;
  KitchenMoment moment = moment_;
  moment.objects[0].first = *ltm::MemoryId::parse("Objects/Instances/kitchen/unicorn_1");
  EXPECT_FAILS(scenes.scene(moment), StatusCode::kInvalidArgument, "unicorn_1");
  moment = moment_;
  moment.joints = idf::Data(int64_t{3});
  EXPECT_FAILS(scenes.scene(moment), StatusCode::kInvalidArgument, "joints");
}

/// With ENGRAM_PICTURES=folder what was recorded and what Blender makes of it are written there.
TEST_F(KitchenSceneTest, LooksLikeWhatWasRecorded) {
  const auto blender = augmentation::Blender::start({.samples = 32});
  if (blender.status().code() == StatusCode::kNotFound)
    GTEST_SKIP() << blender.status().to_string();
  ASSERT_OK(blender);
  KitchenScenes scenes;
  auto scene = scenes.scene(moment_);
  ASSERT_OK(scene);
  const auto image = (*blender)->render(*scene);
  ASSERT_OK(image);
  const auto view = kitchen::View::from_idf(moment_.view);
  ASSERT_OK(view);
  const cv::Mat recorded = view->image;
  const cv::Mat rendered = *typed::mat_of(*image);
  // Light differs somewhat, edges do not: the gradients of both go together.
  const auto edges = [](const cv::Mat& picture) {
    cv::Mat grey;
    cv::cvtColor(picture, grey, cv::COLOR_RGB2GRAY);
    grey.convertTo(grey, CV_32F);
    cv::GaussianBlur(grey, grey, {}, 1);
    cv::Mat x;
    cv::Mat y;
    cv::Sobel(grey, x, CV_32F, 1, 0);
    cv::Sobel(grey, y, CV_32F, 0, 1);
    cv::Mat strength;
    cv::magnitude(x, y, strength);
    return cv::Mat(strength - cv::mean(strength)[0]);
  };
  if (const char* folder = std::getenv("ENGRAM_PICTURES")) {
    cv::Mat both;
    cv::hconcat(recorded, rendered, both);
    cv::cvtColor(both, both, cv::COLOR_RGB2BGR);
    cv::imwrite(std::string(folder) + "/kitchen_scene.png", both);
  }
  cv::Mat apart;
  cv::absdiff(recorded, rendered, apart);
  const cv::Scalar mean = cv::mean(apart);
  EXPECT_LT((mean[0] + mean[1] + mean[2]) / 3, 30);
  const cv::Mat a = edges(recorded);
  const cv::Mat b = edges(rendered);
  // They fit best where they are: not when one is moved by a pixel or more.
  constexpr int kMax = 3;
  const cv::Rect middle(kMax, kMax, a.cols - 2 * kMax, a.rows - 2 * kMax);
  double best = 0;
  cv::Point best_shift(-100, -100);
  for (int y = -kMax; y <= kMax; ++y) {
    for (int x = -kMax; x <= kMax; ++x) {
      const cv::Mat moved = b(middle + cv::Point(x, y));
      const double fit = a(middle).dot(moved) / std::sqrt(moved.dot(moved));
      if (fit > best) {
        best = fit;
        best_shift = {x, y};
      }
    }
  }
  EXPECT_EQ(best_shift, cv::Point(0, 0));
}

}  // namespace
}  // namespace engram::datasets
