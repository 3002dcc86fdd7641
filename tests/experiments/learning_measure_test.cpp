// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "learning/codec_measure.h"
#include "learning/latent_trial.h"
#include "learning/number_measure.h"
#include "learning/video_trial.h"

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

TEST(VideoTrial, TakesWhatTheGroupCodecOfTheSameSettingsTakes) {
  const Clip clip = colourful(8);
  const auto own = VideoTrial::create("av1:effort=4,depth=10,spread=2");
  const auto any = VideoTrial::create("libaom-av1 yuv444p10le cpu-used=5 lag-in-frames=19 qmin=-2");
  ASSERT_TRUE(own.ok() && any.ok());
  const auto expected = own->run(clip.images, 30), found = any->run(clip.images, 30);
  ASSERT_TRUE(expected.ok()) << expected.status().to_string();
  ASSERT_TRUE(found.ok()) << found.status().to_string();
  EXPECT_NEAR(found->bytes, expected->bytes, 0.03 * expected->bytes);
  EXPECT_NEAR(found->min_db(), expected->min_db(), 0.2);
}

TEST(VideoTrial, SaysWhichOptionTheEncoderRefuses) {
  const auto trial = VideoTrial::create("libaom-av1 yuv444p speed=5");
  ASSERT_TRUE(trial.ok());
  const auto result = trial->run(colourful(1).images, 30);
  ASSERT_FALSE(result.ok());
  EXPECT_THAT(result.status().message(), ::testing::HasSubstr("speed=5"));
  EXPECT_FALSE(VideoTrial::create("libnothing yuv444p").ok());
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

TEST(ReadNumbers, RefusesRecordingsOfOtherColumns) {
  const auto folder = std::filesystem::temp_directory_path() / "engram_read_other_numbers";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "a.csv") << "timestamp,state.a\n0,1\n1,2\n";
  std::ofstream(folder / "b.csv") << "timestamp,state.b\n0,1\n1,2\n";
  const auto recordings = read_numbers(folder, {"state."}, 1);
  std::filesystem::remove_all(folder);
  EXPECT_EQ(recordings.status().code(), StatusCode::kInvalidArgument);
}

const double kNaN = std::nan("");

TEST(LargestError, IsTheLargestThatIsWithinTheBound) {
  const std::vector<double> rows{1, 2, kNaN, -3};
  EXPECT_EQ(largest_error("arm", rows, std::vector<double>{1, 2.25, kNaN, -3.5}, 0.5).value(), 0.5);
  const auto beyond = largest_error("arm", rows, std::vector<double>{1, 2.25, kNaN, -4}, 0.5);
  EXPECT_EQ(beyond.status().code(), StatusCode::kDataLoss);
  EXPECT_THAT(beyond.status().message(), testing::HasSubstr("'arm': number 3"));
}

TEST(LargestError, DoesNotHideWhatIsNotANumber) {
  EXPECT_FALSE(largest_error("arm", std::vector{1.0}, std::vector{kNaN}, 0.5).ok());
  EXPECT_FALSE(largest_error("arm", std::vector{kNaN}, std::vector{1.0}, 0.5).ok());
}

/// One joint that jumps between a hundred places.
NumberRecording jumping(double size) {
  std::mt19937 random(1);
  NumberRecording recording{"arm", {"joint"}, {}};
  for (int i = 0; i < 1000; ++i) recording.rows.push_back(random() % 100 * size);
  return recording;
}

TEST(RivalBytes, TakesWiderStepsWhereTheyAreNeeded) {
  const std::vector<NumberRecording> narrow{jumping(1)}, wide{jumping(65536)};
  const auto few = rival_bytes(narrow, 0.5), many = rival_bytes(wide, 0.5);
  ASSERT_TRUE(few.ok() && many.ok());
  // In two bytes all of the wide ones would be zero.
  EXPECT_GT(many->steps, 0.9 * few->steps);
  EXPECT_GT(many->differences, 0.9 * few->differences);
}

TEST(RivalBytes, RefusesWhatHasNoSteps) {
  for (const double hostile : {kNaN, std::numeric_limits<double>::infinity(), 1e300}) {
    std::vector<NumberRecording> recordings{jumping(10)};
    recordings[0].rows[5] = hostile;
    const auto found = rival_bytes(recordings, 0.5);
    EXPECT_EQ(found.status().code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(found.status().message(), testing::HasSubstr("column 'joint'"));
  }
}

/// Three rows of 3 latents in two recordings.
const std::vector<int32_t> kTrial{3, 2, 0, 2, 2, 1, 1, 1, 1, 1, 1, 2, 3, 4, 5, 6, 7, 8, -9};

Result<LatentTrial> read_trial(const std::vector<int32_t>& integers) {
  const auto file = std::filesystem::path(testing::TempDir()) / "engram_latent_trial";
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(integers.data()),
             static_cast<std::streamsize>(integers.size() * sizeof(int32_t)));
  auto trial = read_latent_trial(file);
  std::filesystem::remove(file);
  return trial;
}

TEST(LatentTrial, IsReadAndCutIntoBlocks) {
  const auto trial = read_trial(kTrial);
  ASSERT_TRUE(trial.ok()) << trial.status().to_string();
  EXPECT_EQ(trial->rows, 3u);
  EXPECT_EQ(trial->latents, 3u);
  EXPECT_EQ(blocks_of(*trial, 3), (std::vector<LatentRows>{{1, 2, 3, 4, 5, 6}, {7, 8, -9}}));
  EXPECT_EQ(blocks_of(*trial, 1), (std::vector<LatentRows>{{1, 2, 3}, {4, 5, 6}, {7, 8, -9}}));
}

TEST(LatentTrial, RefusesWhatIsNotWhole) {
  for (size_t size = 0; size < kTrial.size(); ++size)
    EXPECT_EQ(
        read_trial({kTrial.begin(), kTrial.begin() + static_cast<ptrdiff_t>(size)}).status().code(),
        StatusCode::kDataLoss)
        << size;
  for (size_t at = 0; at < 10; ++at) {
    auto hostile = kTrial;
    hostile[at] = 1 << 19;
    EXPECT_EQ(read_trial(hostile).status().code(), StatusCode::kDataLoss) << at;
  }
  EXPECT_EQ(read_latent_trial("no such file").status().code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace engram::experiments
