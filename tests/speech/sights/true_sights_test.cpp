// SPDX-License-Identifier: Apache-2.0
// What images truly show, of a small memory whose geometry is worked out by hand.
#include "speech/sights/true_sights.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::speech {
namespace {

constexpr const char* kImages = "Vision/RGB/head/camera";
constexpr const char* kLens = "Vision/Calibration/head/camera";
constexpr const char* kCubes = "Objects/Classes/kitchen/cube";
constexpr const char* kCans = "Objects/Classes/kitchen/can";
constexpr CellGrid kSeenGrid{.channels = 1, .rows = 8, .columns = 8};

Time second(double seconds) {
  return time_from_ns(1'767'225'600'000'000'000 + static_cast<int64_t>(seconds * 1e9));
}

idf::Data numbers(std::vector<double> values) {
  const auto count = static_cast<int64_t>(values.size());
  return idf::Data(idf::NdArray::take({count}, std::move(values)));
}

idf::Data pose(double x, double y, double z, std::vector<double> orientation = {1, 0, 0, 0}) {
  return idf::Data(idf::Dict{{"position", numbers({x, y, z})},
                             {"orientation", numbers(std::move(orientation))}});
}

/// A camera at the origin looks along the world's x axis, with an image of 64 x 64 pixels that is
/// as wide at 1 m as 1 m. Its x axis is the world's -y, its y axis -z.
class SeenKitchen : public ::testing::Test {
 protected:
  void SetUp() override {
    auto memory = Memory::open((folder_.path() / "kitchen.engram").string());
    ASSERT_OK(memory);
    memory_ = *std::move(memory);
    commit(kLens, {{"fx", 64.0},
                   {"fy", 64.0},
                   {"cx", 31.5},
                   {"cy", 31.5},
                   {"width", 64.0},
                   {"height", 64.0}});
    commit(kImages, {{"pose_world_camera", pose(0, 0, 0, {0.5, -0.5, 0.5, -0.5})},
                     {"calibration", link(kLens)}});
    for (const char* kind : {kCubes, kCans})
      commit(kind, {{"spoken_name", std::string(kind == kCubes ? "cube" : "can")},
                    {"size", numbers({0.2, 0.2, 0.2})}});
  }

  static idf::Data link(const std::string& entity) {
    return idf::Data(ltm::MemoryId::parse(entity)->at(second(0)).instance(0).to_string());
  }

  void commit(const std::string& entity, idf::Dict value) {
    ltm::Commit commit;
    commit.updates.push_back(
        {*ltm::MemoryId::parse(entity), second(0), {{idf::Data(std::move(value)), {}}}});
    ASSERT_OK(memory_->commit(commit));
  }

  void put(const char* name, const char* kind, double x, double y, const char* hand = "") {
    commit(std::string("Objects/Instances/kitchen/") + name, {{"object_class", link(kind)},
                                                              {"pose_world_object", pose(x, y, 0)},
                                                              {"is_visible", true},
                                                              {"held_by", std::string(hand)},
                                                              {"colour", std::string("red")}});
  }

  ImageTruth truth(Time time) {
    auto sights = TrueSights::read(*memory_, words_);
    EXPECT_OK(sights);
    const LatentImage image{ltm::MemoryId::parse(kImages)->at(second(0)).instance(0), time, {}};
    const auto value = sights->value_of(image);
    EXPECT_OK(value);
    const auto found = sights->of(image, *value, kSeenGrid);
    EXPECT_OK(found);
    return found.ok() && *found ? **found : ImageTruth();
  }

  int64_t cell(const ImageTruth& truth, int row, int column) {
    return truth.kinds.at(static_cast<size_t>(row * kSeenGrid.columns + column));
  }

  ScratchDirectory folder_;
  std::unique_ptr<Memory> memory_;
  SightWords words_;
};

TEST_F(SeenKitchen, ShowsAThingWhereItIs) {
  put("cube_1", kCubes, 0.9, 0, "Right_Hand");
  const ImageTruth shown = truth(second(0.1));
  ASSERT_EQ(shown.things.size(), 1U);
  const TrueSight& cube = shown.things.front();
  EXPECT_TRUE(cube.is_in_sight);
  EXPECT_EQ(words_.kinds, std::vector<std::string>{kCubes});
  EXPECT_EQ(words_.where.at(static_cast<size_t>(cube.where)), "right");
  EXPECT_EQ(words_.colours.at(static_cast<size_t>(cube.colour)), "red");
  EXPECT_NEAR(cube.distance_m, 0.9, 1e-6);
  // Its near side is 0.2 m wide at 0.8 m: a quarter of the image, two cells, around the middle.
  float left = 1, right = 0;
  for (const cv::Point2f& corner : cube.outline) {
    left = std::min(left, corner.x);
    right = std::max(right, corner.x);
  }
  EXPECT_NEAR(left, 0.375, 1e-4);
  EXPECT_NEAR(right, 0.625, 1e-4);
  for (int row = 0; row < 8; ++row)
    for (int column = 0; column < 8; ++column) {
      const bool is_cube = (row == 3 || row == 4) && (column == 3 || column == 4);
      EXPECT_EQ(cell(shown, row, column), is_cube ? cube.kind : ImageTruth::kNothing)
          << row << " " << column;
    }
}

TEST_F(SeenKitchen, ShowsTheNearerOfTwoThings) {
  put("cube_1", kCubes, 0.9, 0);
  put("can_1", kCans, 1.9, -0.3);
  const ImageTruth shown = truth(second(0));
  ASSERT_EQ(shown.things.size(), 2U);
  EXPECT_GT(shown.things[0].distance_m, shown.things[1].distance_m);
  EXPECT_EQ(cell(shown, 3, 4), shown.things[1].kind) << "the cube is before it";
  // The can is right of it: -y is right.
  EXPECT_EQ(cell(shown, 4, 5), shown.things[0].kind);
  EXPECT_EQ(cell(shown, 4, 2), ImageTruth::kNothing);
}

TEST_F(SeenKitchen, ShowsNothingOfWhatIsBehindOrWasLongAgo) {
  put("cube_1", kCubes, -0.9, 0);
  const ImageTruth behind = truth(second(0));
  ASSERT_EQ(behind.things.size(), 1U);
  EXPECT_FALSE(behind.things.front().is_in_sight);
  EXPECT_TRUE(behind.things.front().outline.empty());
  EXPECT_TRUE(truth(second(2)).things.empty()) << "nobody told of it for two seconds";
}

TEST(MaskOf, CountsPixelsWhoseMiddleIsWithin) {
  const cv::Mat mask =
      mask_of({{0.25F, 0.25F}, {0.75F, 0.25F}, {0.75F, 0.5F}, {0.25F, 0.5F}}, {8, 8});
  EXPECT_EQ(cv::countNonZero(mask), 4 * 2);
  EXPECT_EQ(mask.at<uint8_t>(2, 2), 255);
  EXPECT_EQ(mask.at<uint8_t>(1, 2), 0);
  EXPECT_EQ(cv::countNonZero(mask_of({}, {8, 8})), 0);
  EXPECT_EQ(cv::countNonZero(mask_of({{-2, -2}, {3, -2}, {3, 3}, {-2, 3}}, {8, 8})), 64)
      << "what is beyond the image is cut off";
}

}  // namespace
}  // namespace engram::speech
