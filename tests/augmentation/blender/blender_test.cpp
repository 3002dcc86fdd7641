// SPDX-License-Identifier: Apache-2.0
#include "augmentation/blender/blender.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "tests/augmentation/blender/some_scene.h"
#include "tests/ltm/expect_status.h"

namespace engram::augmentation {
namespace {

using ::testing::Lt;

/// Where a point of the world is seen. Unit: pixels.
std::array<double, 2> project(const SceneCamera& camera, const std::array<double, 3>& point) {
  std::array<double, 3> seen{};
  for (size_t axis = 0; axis < 3; ++axis)
    for (size_t row = 0; row < 3; ++row)
      seen[axis] += camera.pose[4 * row + axis] * (point[row] - camera.pose[4 * row + 3]);
  return {camera.fx * seen[0] / seen[2] + camera.cx, camera.fy * seen[1] / seen[2] + camera.cy};
}

class BlenderTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    auto started = Blender::start({.samples = 16, .threads = 2});
    if (started.ok())
      blender_ = *std::move(started);
    else if (started.status().code() != StatusCode::kNotFound)
      FAIL() << started.status().to_string();
  }
  static void TearDownTestSuite() { blender_.reset(); }
  void SetUp() override {
    if (!blender_) GTEST_SKIP() << "needs Blender";
  }

  static std::vector<uint8_t> render(const Scene& scene) {
    const auto image = blender_->render(scene);
    EXPECT_OK(image);
    if (!image.ok()) return {};
    const auto bytes = std::as_bytes(std::span(image->bytes()));
    std::vector<uint8_t> pixels;
    for (const std::byte byte : bytes) pixels.push_back(std::to_integer<uint8_t>(byte));
    return pixels;
  }

  static std::unique_ptr<Blender> blender_;
};

std::unique_ptr<Blender> BlenderTest::blender_;

TEST_F(BlenderTest, SeesPointsWhereThePinholeDoes) {
  for (const double aspect : {1.0, 0.8}) {
    for (const std::array<double, 3> point :
         {std::array{0.0, 0.0, 0.0}, std::array{-0.6, 0.3, 0.2}, std::array{0.6, -0.3, 0.4}}) {
      Scene scene = some_scene();
      scene.camera.fy *= aspect;
      scene.shapes.clear();
      scene.lamps.clear();
      scene.ambient = {0, 0, 0};
      SceneShape light{"",
                       ShapeKind::kEllipsoid,
                       {0.03, 0.03, 0.03},
                       at(point[0], point[1], point[2]),
                       {1, 1, 1}};
      light.emission = 1;
      scene.shapes.push_back(light);
      const auto pixels = render(scene);
      double sum = 0;
      double x = 0;
      double y = 0;
      for (size_t i = 0; i < pixels.size() / 3; ++i) {
        sum += pixels[3 * i];
        x += pixels[3 * i] * static_cast<double>(i % 160);
        y += pixels[3 * i] * static_cast<double>(i / 160);
      }
      ASSERT_GT(sum, 0);
      const auto wanted = project(scene.camera, point);
      EXPECT_NEAR(x / sum, wanted[0], 0.5);
      EXPECT_NEAR(y / sum, wanted[1], 0.5);
    }
  }
}

TEST_F(BlenderTest, DrawsEqualScenesEqually) {
  EXPECT_EQ(render(some_scene()), render(some_scene()));
}

TEST_F(BlenderTest, ChangesTheRecolouredThingAlone) {
  const auto before = render(some_scene());
  Scene scene = some_scene();
  ASSERT_OK(recolour(scene, "can", {0.9, 0.9, 0.1}));
  const auto after = render(scene);
  const auto middle = project(scene.camera, {0.3, 0.1, 0.1});
  int changed = 0;
  for (int i = 0; i < 160 * 120; ++i) {
    const auto at = static_cast<size_t>(3 * i);
    if (before[at] == after[at] && before[at + 1] == after[at + 1]) continue;
    ++changed;
    // The can is 0.23 m from corner to corner, 2.4 m away.
    EXPECT_THAT(std::hypot(i % 160 - middle[0], i / 160 - middle[1]), Lt(12))
        << i % 160 << ", " << i / 160 << ": " << int(before[at]) << " to " << int(after[at]);
  }
  EXPECT_GT(changed, 60);
}

TEST_F(BlenderTest, HidesAShapeAndLeavesItsShadow) {
  Scene table = some_scene();
  std::erase_if(table.shapes, [](const SceneShape& shape) { return !shape.thing.empty(); });
  Scene hidden = some_scene();
  for (SceneShape& shape : hidden.shapes) shape.is_seen = shape.thing.empty();
  const auto alone = render(table);
  const auto shaded = render(hidden);
  // Nothing is brighter than the table alone, and some of it is darker.
  int darker = 0;
  for (size_t i = 0; i < alone.size(); ++i) {
    ASSERT_LE(shaded[i], alone[i] + 3);
    darker += shaded[i] + 10 < alone[i] ? 1 : 0;
  }
  EXPECT_GT(darker, 300);
}

TEST_F(BlenderTest, LightsWithAndWithoutFallingOff) {
  // A white floor 1 m and 2 m below the lamp.
  const auto brightest = [](double height, bool falls_off) {
    Scene scene = some_scene();
    scene.shapes = {{"", ShapeKind::kBox, {2, 2, 0.01}, at(0, 0, -0.01), {1, 1, 1}}};
    scene.lamps = {{LampKind::kPoint, at(0, 0, height), 2, 0.05}};
    scene.lamps[0].falls_off = falls_off;
    scene.ambient = {0, 0, 0};
    const auto pixels = render(scene);
    return *std::ranges::max_element(pixels);
  };
  EXPECT_NEAR(brightest(1, false), brightest(1, true), 2);
  EXPECT_NEAR(brightest(2, false), brightest(1, false), 4);
  EXPECT_LT(brightest(2, true), brightest(1, true) * 0.7);
}

TEST_F(BlenderTest, RefusesWhatIsNoScene) {
  Scene scene = some_scene();
  scene.camera.width = 0;
  EXPECT_FAILS(blender_->render(scene), StatusCode::kInvalidArgument, "0 x 120");
}

TEST(Blender, SaysHowToGetIt) {
  EXPECT_FAILS(Blender::start({.program = "no-such-blender"}), StatusCode::kNotFound,
               "apt install blender");
}

}  // namespace
}  // namespace engram::augmentation
