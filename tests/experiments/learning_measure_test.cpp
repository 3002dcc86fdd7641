// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "learning/codec_measure.h"
#include "learning/number_data.h"

namespace engram::experiments {
namespace {

/// Saturated colours that move slowly: a wrong colour matrix costs several dB here.
Clip colourful(int frames) {
  Clip clip{"colours", {}};
  for (int t = 0; t < frames; ++t) {
    std::vector<uint8_t> pixels;
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x)
        for (int c = 0; c < 3; ++c)
          pixels.push_back(static_cast<uint8_t>(
              std::lround(127.5 + 120 * std::sin((x + 2 * t) * 0.05 + y * 0.03 + 2.1 * c))));
    clip.images.push_back(idf::NdArray::take<uint8_t>({128, 128, 3}, std::move(pixels)));
  }
  return clip;
}

TEST(MeasureCodec, KeepsColoursAtHighQuality) {
  const Clip clip = colourful(12);
  for (const char* codec : {"h264:crf=4", "h265:crf=4", "av1:crf=4"})
    for (const size_t group : {0, 5}) {
      const auto figures = measure_codec(clip, codec, group);
      ASSERT_TRUE(figures.ok()) << figures.status().to_string();
      EXPECT_EQ(figures->psnr.count(), 12u);
      EXPECT_EQ(figures->moving.count(), 11u);
      EXPECT_GT(figures->psnr.minimum_db(), 45) << codec << ", group " << group;
      EXPECT_GT(figures->ssim, 0.98) << codec;
    }
}

TEST(MeasureCodec, FindsNoErrorWhereThereIsNone) {
  const auto figures = measure_codec(colourful(3), "ffv1", 0);
  ASSERT_TRUE(figures.ok());
  EXPECT_EQ(figures->psnr.capped(), 3u);
  EXPECT_NEAR(figures->ssim, 1, 1e-12);
}

TEST(ReadNumbers, TakesRowsAndColumnsInTheOrderAskedFor) {
  const auto folder = std::filesystem::temp_directory_path() / "engram_read_numbers";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "a.csv")
      << "timestamp,state.a,action.a,other\n0,1,2,9\n1,3,4,9\n2,5,6,9\n";
  const auto recordings = read_numbers(folder, {"action.", "state."}, 2);
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(recordings.ok()) << recordings.status().to_string();
  EXPECT_EQ((*recordings)[0].columns, (std::vector<std::string>{"action.a", "state.a"}));
  EXPECT_EQ((*recordings)[0].rows, (std::vector<double>{2, 1, 6, 5}));
  EXPECT_EQ(read_numbers(folder, {"state."}, 1).status().code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace engram::experiments
