// SPDX-License-Identifier: Apache-2.0
#include "datasets/drawn_scene.h"

#include <gtest/gtest.h>

#include "datasets/media/table.h"
#include "datasets/media/video_reader.h"
#include "tests/datasets/fixtures.h"

namespace engram::datasets {
namespace {

using testing::TemporaryDirectory;

constexpr SceneOptions kShort{.width = 96, .height = 72, .seconds = 8, .rate_hz = 15, .seed = 3};

TEST(Scene, GivesEqualFramesForEqualSeedsInAnyOrder) {
  const auto a = Scene::create(kShort), b = Scene::create(kShort);
  ASSERT_TRUE(a.ok() && b.ok());
  ASSERT_EQ(a->frames(), 120u);
  const auto late = b->render(100);
  for (const uint64_t index : {uint64_t{0}, uint64_t{50}})
    EXPECT_TRUE(a->render(index)->image == b->render(index)->image);
  EXPECT_TRUE(a->render(100)->image == late->image);
}

TEST(Scene, DiffersBetweenSeeds) {
  SceneOptions other = kShort;
  other.seed = 4;
  EXPECT_FALSE(Scene::create(kShort)->render(0)->image == Scene::create(other)->render(0)->image);
}

TEST(Scene, KeepsTheRoomStillButForTheNoise) {
  SceneOptions quiet = kShort;
  quiet.noise_sigma = 0;
  const auto scene = Scene::create(quiet);
  const auto first = scene->render(0), last = scene->render(119);
  size_t same = 0;
  for (size_t i = 0; i < first->image.values<uint8_t>().size(); ++i)
    same += first->image.values<uint8_t>()[i] == last->image.values<uint8_t>()[i] ? 1 : 0;
  EXPECT_FALSE(first->image == last->image) << "the arm moves";
  EXPECT_GT(same, first->image.values<uint8_t>().size() * 7 / 10);
  const double noise_db = testing::psnr_db(first->image, Scene::create(kShort)->render(0)->image);
  EXPECT_NEAR(noise_db, 44.5, 0.5) << "sigma of 1.5 grey levels, rounded";
}

TEST(Scene, MovesTheArmSmoothlyAndTellsItsVelocity) {
  const auto scene = Scene::create({.width = 32, .height = 32, .seconds = 20, .rate_hz = 120});
  auto before = scene->render(0)->arm;
  bool has_moved = false, has_closed = false;
  for (uint64_t i = 1; i < scene->frames(); ++i) {
    const ArmState arm = scene->render(i)->arm;
    const double speed = (arm.shoulder_velocity_rad_s + before.shoulder_velocity_rad_s) / 2;
    EXPECT_NEAR((arm.shoulder_rad - before.shoulder_rad) * 120, speed, 0.05) << i;
    EXPECT_LT(std::abs(arm.elbow_velocity_rad_s - before.elbow_velocity_rad_s), 0.6) << i;
    EXPECT_LE(arm.elbow_rad, 0);
    has_moved = has_moved || std::abs(speed) > 0.5;
    has_closed = has_closed || arm.gripper < 0.2;
    before = arm;
  }
  EXPECT_TRUE(has_moved);
  EXPECT_TRUE(has_closed);
}

TEST(Scene, WritesAVideoAndATableOfTheSameTimes) {
  const TemporaryDirectory directory;
  uint64_t told = 0;
  const Status status = write_scene(kShort, directory / "a.mp4", directory / "a.csv",
                                    [&told](const Progress& progress) { told = progress.done; });
  ASSERT_TRUE(status.ok()) << status.to_string();
  EXPECT_EQ(told, 120u);
  const auto table = Table::read(directory / "a.csv", {});
  ASSERT_TRUE(table.ok()) << table.status().to_string();
  ASSERT_EQ(table->rows(), 120u);
  EXPECT_NE(table->row_value(0).at("velocity/elbow"), nullptr);
  const auto scene = Scene::create(kShort);
  EXPECT_EQ(table->row_value(60).at("joint/shoulder")->get<double>(),
            scene->render(60)->arm.shoulder_rad);

  auto reader = VideoReader::open(directory / "a.mp4", {});
  ASSERT_TRUE(reader.ok());
  const auto [frames, end] = testing::read_all(*reader);
  ASSERT_EQ(frames.size(), 120u);
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].time, table->times()[i]);
    EXPECT_EQ(frames[i].time, scene->render(i)->time);
  }
  EXPECT_GT(testing::psnr_db(frames[60].image, scene->render(60)->image), 32);
}

TEST(Scene, WritesEqualBytesForEqualOptions) {
  const TemporaryDirectory directory;
  for (const char* name : {"a", "b"})
    ASSERT_TRUE(write_scene(kShort, directory / (std::string(name) + ".mp4"),
                            directory / (std::string(name) + ".csv"), nullptr)
                    .ok());
  EXPECT_TRUE(testing::content_of(directory / "a.mp4") == testing::content_of(directory / "b.mp4"));
  EXPECT_TRUE(testing::content_of(directory / "a.csv") == testing::content_of(directory / "b.csv"));
}

TEST(Scene, DrawsAnyShapeOfImage) {
  for (const auto& [width, height] : {std::pair{32, 32}, {256, 64}, {64, 256}}) {
    const auto scene = Scene::create({.width = width, .height = height, .seconds = 1});
    ASSERT_TRUE(scene.ok());
    EXPECT_EQ(scene->render(0)->image.shape(), (idf::Shape{height, width, 3}));
  }
}

TEST(Scene, RejectsOptionsThatCannotBe) {
  for (const SceneOptions& options :
       {SceneOptions{.width = 33}, SceneOptions{.height = 16}, SceneOptions{.seconds = 0},
        SceneOptions{.seconds = NAN}, SceneOptions{.seconds = 1e6}, SceneOptions{.rate_hz = 0},
        SceneOptions{.noise_sigma = -1}})
    EXPECT_EQ(Scene::create(options).status().code(), StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace engram::datasets
