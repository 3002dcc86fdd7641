// SPDX-License-Identifier: Apache-2.0
// What holds for all detectors.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <thread>

#include "ltm/redaction/detector_registry.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/redaction/marker_program.h"
#include "tests/ltm/redaction/onnx_file.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::ltm {
namespace {

class DetectorConformance : public ::testing::TestWithParam<std::string_view> {
 protected:
  void SetUp() override {
    auto made = make_detector(options());
    ASSERT_OK(made);
    detector_ = *std::move(made);
  }

  [[nodiscard]] DetectorOptions options() const {
    if (GetParam() == "people") return PeopleDetector::Options();
    if (GetParam() == "faces") return FacesDetector::Options();
    if (GetParam() == "onnx")
      return OnnxDetector::Options{testing::bright_cells_onnx(scratch_.path(), false), 0.9, {}, 64};
    return ProgramDetector::Options{testing::marker_program(scratch_.path()),
                                    std::chrono::minutes(1)};
  }

  /// Finds in an image of these pixels, whose boxes must be usable.
  std::vector<Box> find(int width, int height, int channels, const std::vector<uint8_t>& pixels) {
    auto boxes = detector_->find({width, height, channels, pixels, "A/b/c/d", "image", Time{}});
    EXPECT_OK(boxes);
    if (!boxes.ok()) return {};
    EXPECT_LE(boxes->size(), kMaxBoxes);
    for (const Box& box : *boxes) {
      EXPECT_TRUE(std::isfinite(box.x) && std::isfinite(box.y));
      EXPECT_GT(box.width, 0);
      EXPECT_GT(box.height, 0);
    }
    return *std::move(boxes);
  }

  static std::vector<uint8_t> noise(int width, int height, int channels) {
    std::mt19937 random(7);
    std::vector<uint8_t> pixels(static_cast<size_t>(width) * height * channels);
    for (uint8_t& each : pixels) each = static_cast<uint8_t>(random());
    return pixels;
  }

  ScratchDirectory scratch_;
  std::unique_ptr<Detector> detector_;
};

TEST_P(DetectorConformance, IsCalledAsItIsConfigured) {
  EXPECT_EQ(detector_->name(), GetParam());
}

TEST_P(DetectorConformance, FindsNothingInAnImageThatIsEmptyOrOnePixel) {
  EXPECT_TRUE(find(0, 0, 3, {}).empty());
  EXPECT_TRUE(find(0, 480, 1, {}).empty());
  EXPECT_TRUE(find(1, 1, 1, {0}).empty());
  EXPECT_TRUE(find(1, 1, 3, {10, 20, 30}).empty());
}

TEST_P(DetectorConformance, TakesGreyAndColour) {
  EXPECT_TRUE(find(320, 240, 3, std::vector<uint8_t>(320 * 240 * 3, 60)).empty());
  EXPECT_TRUE(find(320, 240, 1, std::vector<uint8_t>(320 * 240, 60)).empty());
}

TEST_P(DetectorConformance, TakesAllShapesOfNoise) {
  for (const auto& [width, height] :
       {std::pair{16, 16}, {17, 300}, {300, 17}, {2000, 16}, {16, 2000}})
    for (const int channels : {1, 3}) find(width, height, channels, noise(width, height, channels));
}

TEST_P(DetectorConformance, TakesAHugeImage) {
  find(5000, 3000, 3, noise(5000, 3000, 3));
}

TEST_P(DetectorConformance, FindsTheSameInTheSameImageInAllThreads) {
  const auto pixels = noise(200, 160, 3);
  const auto first = find(200, 160, 3, pixels);
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] { EXPECT_EQ(find(200, 160, 3, pixels), first); });
  for (std::thread& thread : threads) thread.join();
}

INSTANTIATE_TEST_SUITE_P(All, DetectorConformance, ::testing::ValuesIn(all_detectors()),
                         [](const auto& of) { return std::string(of.param); });

}  // namespace
}  // namespace engram::ltm
