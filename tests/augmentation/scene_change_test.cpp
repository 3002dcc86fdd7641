// SPDX-License-Identifier: Apache-2.0
#include "augmentation/scene_change.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <set>

#include "tests/ltm/expect_status.h"

namespace engram::augmentation {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

PartPose at(double x, double y, double z) {
  return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1};
}

Matrix matrix_of(const PartPose& pose) {
  return Eigen::Map<const Matrix>(pose.data());
}

Scene three_things() {
  Scene scene;
  scene.camera = {320, 240, 300, 310, 161, 117, at(0.1, 0.2, 0.3)};
  for (const auto& [name, x] : {std::pair{"cup", 0.0}, {"box", 1.0}, {"jar", 2.0}})
    scene.shapes.push_back({name, ShapeKind::kBox, {0.1, 0.1, 0.1}, at(x, 0, 1)});
  scene.shapes.push_back({"", ShapeKind::kBox, {5, 5, 0.1}, at(0, 0, 0)});
  scene.lamps.push_back({LampKind::kPoint, at(0, 0, 2)});
  scene.lamps.push_back({LampKind::kSun, at(0, 0, 3)});
  return scene;
}

Change drawn(SceneChangeKind kind, const Scene& scene, const std::vector<std::string>& in_sight,
             uint64_t seed = 1) {
  Random random(seed);
  const auto change = draw_scene_change(kind, scene, in_sight, 100, random);
  EXPECT_TRUE(change.has_value());
  return change.value_or(Change{});
}

std::string thing_of(const Change& change) {
  return change.parameters.find("thing")->get<std::string>();
}

TEST(SceneChange, HasNames) {
  for (const SceneChangeKind kind : all_scene_changes())
    EXPECT_EQ(parse_scene_change(to_string(kind)).value(), kind);
  EXPECT_FAILS(parse_scene_change("fog"), StatusCode::kInvalidArgument, "'fog'");
}

TEST(SceneChange, IsDrawnFromTheSeedAlone) {
  const Scene scene = three_things();
  for (const SceneChangeKind kind : all_scene_changes()) {
    const Change one = drawn(kind, scene, {"cup", "jar"}, 1);
    EXPECT_EQ(one, drawn(kind, scene, {"cup", "jar"}, 1));
    bool differs = false;
    for (uint64_t seed = 2; seed < 20; ++seed)
      differs |= !(one == drawn(kind, scene, {"cup", "jar"}, seed));
    EXPECT_EQ(differs, kind != SceneChangeKind::kOriginal);
  }
}

TEST(SceneChange, ChangesAThingThatIsInSight) {
  std::set<std::string> seen;
  for (uint64_t seed = 0; seed < 50; ++seed) {
    seen.insert(thing_of(drawn(SceneChangeKind::kRecolour, three_things(), {"cup", "jar"}, seed)));
    EXPECT_EQ(thing_of(drawn(SceneChangeKind::kReplace, three_things(), {"box"}, seed)), "box");
  }
  EXPECT_THAT(seen, ElementsAre("cup", "jar"));
}

TEST(SceneChange, StaysWithAThingAsLongAsItIsInSight) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const auto thing = [&](const std::vector<std::string>& in_sight) {
      return thing_of(drawn(SceneChangeKind::kRecolour, three_things(), in_sight, seed));
    };
    const std::string first = thing({"cup", "box", "jar"});
    EXPECT_EQ(thing({first}), first);
    EXPECT_EQ(thing({"jar", first}), first);
  }
}

TEST(SceneChange, IsNotDrawnWithoutAThing) {
  Random random(1);
  for (const auto kind : {SceneChangeKind::kRecolour, SceneChangeKind::kReplace})
    EXPECT_FALSE(draw_scene_change(kind, three_things(), {"unicorn"}, 50, random));
  Scene one = three_things();
  std::erase_if(one.shapes, [](const SceneShape& shape) { return shape.thing != "cup"; });
  EXPECT_FALSE(draw_scene_change(SceneChangeKind::kReplace, one, {"cup"}, 50, random));
}

TEST(SceneChange, RecoloursAndReplacesOneThingAlone) {
  const Scene before = three_things();
  Scene scene = before;
  ASSERT_OK(change_scene(scene, drawn(SceneChangeKind::kRecolour, scene, {"box"}), {}));
  for (size_t i = 0; i < scene.shapes.size(); ++i)
    EXPECT_EQ(scene.shapes[i].colour == before.shapes[i].colour, before.shapes[i].thing != "box");
  scene = before;
  const Change change{"scene_replace", {{"thing", "box"}, {"by", "jar"}}};
  ASSERT_OK(change_scene(scene, change, {}));
  EXPECT_EQ(scene.shapes.size(), before.shapes.size());
}

TEST(SceneChange, MovesCamerasOfARigTogether) {
  Scene left = three_things();
  Scene right = left;
  right.camera.pose[3] += 0.07;
  const PartPose rig = left.camera.pose;
  const Matrix between = matrix_of(left.camera.pose).inverse() * matrix_of(right.camera.pose);
  const Change change = drawn(SceneChangeKind::kView, left, {});
  ASSERT_OK(change_scene(left, change, rig));
  ASSERT_OK(change_scene(right, change, rig));
  EXPECT_FALSE(left.camera.pose == rig);
  EXPECT_TRUE((matrix_of(left.camera.pose).inverse() * matrix_of(right.camera.pose))
                  .isApprox(between, 1e-12));
  const Eigen::Matrix3d turn = matrix_of(left.camera.pose).block<3, 3>(0, 0);
  EXPECT_TRUE((turn * turn.transpose()).isIdentity(1e-12));
  const Matrix moved = matrix_of(left.camera.pose) - matrix_of(rig);
  EXPECT_LE((moved.block<3, 1>(0, 3)).norm(), 0.2 * 1.8);
}

TEST(SceneChange, ChangesAllLampsAndMovesThoseThatAreSomewhere) {
  Scene scene = three_things();
  const Change change{"scene_light",
                      {{"lamps_percent", int64_t{50}},
                       {"ambient_percent", int64_t{200}},
                       {"warmth_percent", int64_t{100}},
                       {"lamps_x_mm", int64_t{500}},
                       {"lamps_y_mm", int64_t{-250}}}};
  ASSERT_OK(change_scene(scene, change, {}));
  EXPECT_EQ(scene.lamps[0].strength, 50);
  EXPECT_EQ(scene.lamps[0].pose, at(0.5, -0.25, 2));
  EXPECT_EQ(scene.lamps[1].pose, at(0, 0, 3));
  EXPECT_THAT(scene.lamps[1].colour, ElementsAre(1.25, 1, 0.75));
  EXPECT_DOUBLE_EQ(scene.ambient[1], 0.6);
}

TEST(SceneChange, RefusesRecipesThatAreNot) {
  Scene scene = three_things();
  const auto refuses = [&](const Change& change, const char* what) {
    const Status status = change_scene(scene, change, scene.camera.pose);
    EXPECT_FALSE(status.ok());
    EXPECT_THAT(status.to_string(), ::testing::HasSubstr(what));
  };
  refuses({"brightness", {{"levels", int64_t{3}}}}, "none of scenes");
  refuses({"scene_fog", {}}, "'fog'");
  refuses({"scene_recolour", {{"thing", "cup"}, {"red", int64_t{256}}}}, "'red' is 256");
  refuses({"scene_recolour", {{"thing", 3.0}}}, "'thing' needs a text");
  refuses({"scene_replace", {{"thing", "cup"}, {"by", "unicorn"}}}, "'unicorn'");
  refuses({"scene_view", {}}, "'right_mm'");
  refuses({"scene_light", {{"lamps_percent", int64_t{-1}}}}, "'lamps_percent' is -1");
}

TEST(SceneChange, KeepsWhereThingsAreSeenWithFewerPixels) {
  const SceneCamera full = three_things().camera;
  EXPECT_EQ(scaled_down(full, 640).width, 320);
  const SceneCamera half = scaled_down(full, 160);
  EXPECT_EQ(half.width, 160);
  EXPECT_EQ(half.height, 120);
  const Eigen::Vector3d point(0.3, -0.2, 2);
  const auto edge = [&](const SceneCamera& camera) {
    return Eigen::Vector2d((camera.fx * point.x() / point.z() + camera.cx + 0.5) / camera.width,
                           (camera.fy * point.y() / point.z() + camera.cy + 0.5) / camera.height);
  };
  EXPECT_TRUE(edge(full).isApprox(edge(half), 1e-12));
}

}  // namespace
}  // namespace engram::augmentation
