// SPDX-License-Identifier: Apache-2.0
#include "augmentation/blender/scene.h"

#include <gmock/gmock.h>

#include "tests/augmentation/blender/some_scene.h"
#include "tests/ltm/expect_status.h"

namespace engram::augmentation {
namespace {

TEST(Scene, NamesWhatIsWrongWithIt) {
  EXPECT_OK(some_scene().validate());
  Scene scene = some_scene();
  scene.shapes[1].half[2] = 0;
  EXPECT_FAILS(scene.validate(), StatusCode::kInvalidArgument, "'box'");
  scene = some_scene();
  scene.shapes[2].texture = 0;
  EXPECT_FAILS(scene.validate(), StatusCode::kInvalidArgument, "found texture 0 of 0");
  scene = some_scene();
  scene.camera.fx = 0;
  EXPECT_FAILS(scene.validate(), StatusCode::kInvalidArgument, "focal lengths 0");
  scene = some_scene();
  scene.textures.push_back(idf::NdArray::take<uint8_t>({2, 2}, {1, 2, 3, 4}));
  EXPECT_FAILS(scene.validate(), StatusCode::kInvalidArgument, "uint8 [2, 2]");
}

TEST(Scene, RecoloursOneThing) {
  Scene scene = some_scene();
  ASSERT_OK(recolour(scene, "can", {0, 1, 0}));
  EXPECT_EQ(scene.shapes[2].colour[1], 1);
  EXPECT_EQ(scene.shapes[1].colour[1], 0.2);
  EXPECT_FAILS(recolour(scene, "cup", {0, 1, 0}), StatusCode::kNotFound, "'cup'");
}

TEST(Scene, PutsAThingWhereAnotherStood) {
  Scene scene = some_scene();
  ASSERT_OK(replace(scene, "can", some_scene(), "box"));
  ASSERT_EQ(scene.shapes.size(), 3u);
  const SceneShape& placed = scene.shapes[2];
  EXPECT_EQ(placed.thing, "can");
  EXPECT_EQ(placed.kind, ShapeKind::kBox);
  EXPECT_DOUBLE_EQ(placed.pose[3], 0.3);
  EXPECT_DOUBLE_EQ(placed.pose[7], 0.1);
  EXPECT_DOUBLE_EQ(placed.pose[11], 0.15) << "it stands on the table";
  EXPECT_FAILS(replace(scene, "can", some_scene(), "cup"), StatusCode::kNotFound, "'cup'");
}

TEST(Scene, BringsThePicturesOfWhatIsPutThere) {
  Scene other = some_scene();
  other.textures.push_back(idf::NdArray::take<uint8_t>({1, 1, 3}, {1, 2, 3}));
  other.shapes[1].texture = 0;
  Scene scene = some_scene();
  scene.textures.push_back(idf::NdArray::take<uint8_t>({1, 1, 3}, {9, 9, 9}));
  ASSERT_OK(replace(scene, "can", other, "box"));
  EXPECT_EQ(scene.shapes[2].texture, 1);
  EXPECT_EQ(scene.textures.size(), 2u);
  EXPECT_OK(scene.validate());
}

}  // namespace
}  // namespace engram::augmentation
