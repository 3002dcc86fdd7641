// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/video_writer.h"

#include <gtest/gtest.h>

#include "datasets/media/video_reader.h"
#include "tests/datasets/fixtures.h"

namespace engram::datasets {
namespace {

using testing::TemporaryDirectory;

/// Writes and reads 40 images; expects exact times and at least this quality on every image.
void expect_round_trip(const VideoWriter::Options& options, double min_psnr_db) {
  const TemporaryDirectory directory;
  constexpr int kCount = 40;
  const Status status = testing::write_video(directory / "a.mp4", kCount, options);
  ASSERT_TRUE(status.ok()) << status.to_string();
  auto reader = VideoReader::open(directory / "a.mp4", {});
  ASSERT_TRUE(reader.ok()) << reader.status().to_string();
  EXPECT_EQ(reader->info().codec, "h264");
  EXPECT_EQ(reader->info().approximate_frames, uint64_t{kCount});
  const auto [frames, end] = testing::read_all(*reader);
  ASSERT_TRUE(end.ok()) << end.to_string();
  ASSERT_EQ(frames.size(), size_t{kCount});
  EXPECT_EQ(reader->damaged_frames(), 0u);
  for (int i = 0; i < kCount; ++i) {
    const VideoFrame& frame = frames[static_cast<size_t>(i)];
    const double ns = 1e9 * i * options.rate_denominator / options.rate_numerator;
    EXPECT_EQ(frame.time.count(), std::llround(ns)) << i;
    EXPECT_GT(
        testing::psnr_db(frame.image, testing::smooth_image(options.width, options.height, i)),
        min_psnr_db)
        << i;
  }
}

TEST(VideoWriter, RoundTripsSmoothImagesAt30Hz) {
  expect_round_trip({.width = 128, .height = 96, .crf = 10}, 38);
}

TEST(VideoWriter, RoundTripsWithFullChroma) {
  expect_round_trip({.width = 128, .height = 96, .crf = 10, .keeps_chroma = true}, 40);
}

TEST(VideoWriter, RoundTripsAtAFractionalRate) {
  expect_round_trip(
      {.width = 64, .height = 64, .rate_numerator = 30000, .rate_denominator = 1001, .crf = 10},
      38);
}

/// Runs a program and gives its exit status; what it says goes to `directory`/said.
int run(const TemporaryDirectory& directory, const std::string& command) {
  const std::string line = "cd '" + (directory / "").string() + "' && " + command + " >said 2>&1";
  return std::system(line.c_str());
}

TEST(VideoWriter, WritesWhatFFmpegPlaysWithoutComplaint) {
  const TemporaryDirectory directory;
  if (run(directory, "ffmpeg -version") != 0) GTEST_SKIP() << "no ffmpeg";
  constexpr int kCount = 40;
  constexpr size_t kBytes = size_t{128} * 96 * 3;
  for (const bool keeps_chroma : {false, true}) {
    const VideoWriter::Options options{
        .width = 128, .height = 96, .crf = 10, .keeps_chroma = keeps_chroma};
    ASSERT_TRUE(testing::write_video(directory / "a.mp4", kCount, options).ok());
    EXPECT_EQ(run(directory,
                  "ffmpeg -nostdin -v warning -xerror -y -i a.mp4 -fps_mode passthrough "
                  "-f rawvideo -pix_fmt rgb24 all.rgb"),
              0);
    EXPECT_EQ(std::filesystem::file_size(directory / "said"), 0u);
    const std::string played = testing::content_of(directory / "all.rgb");
    ASSERT_EQ(played.size(), kCount * kBytes);
    for (size_t i = 0; i < kCount; ++i) {
      const std::string_view pixels = std::string_view(played).substr(i * kBytes, kBytes);
      const auto image =
          idf::NdArray::take({96, 128, 3}, std::vector<uint8_t>(pixels.begin(), pixels.end()));
      EXPECT_GT(testing::psnr_db(image, testing::smooth_image(128, 96, static_cast<int>(i))), 38)
          << i;
    }
    // From the middle, as players jump.
    EXPECT_EQ(run(directory,
                  "ffmpeg -nostdin -v warning -xerror -y -ss 0.5 -i a.mp4 -frames:v 1 "
                  "-f rawvideo -pix_fmt rgb24 one.rgb"),
              0);
    EXPECT_EQ(std::filesystem::file_size(directory / "one.rgb"), kBytes);
  }
}

TEST(VideoWriter, RoundTripsSlowAndHighDefinitionVideo) {
  expect_round_trip({.width = 64, .height = 64, .rate_numerator = 1, .rate_denominator = 7}, 34);
  expect_round_trip({.width = 64, .height = 736, .rate_numerator = 15, .crf = 10}, 38);
}

TEST(VideoWriter, RoundTripsOddSizesWithFullChroma) {
  expect_round_trip({.width = 37, .height = 51, .crf = 8, .keeps_chroma = true}, 38);
}

TEST(VideoWriter, PutsImagesAtTheirTimes) {
  const TemporaryDirectory directory;
  auto writer =
      VideoWriter::create(directory / "a.mp4", {.width = 64, .height = 48, .has_times = true});
  ASSERT_TRUE(writer.ok()) << writer.status().to_string();
  // The third comes with the time of the second, which a video cannot have twice.
  const std::vector<int64_t> times_us{0, 100'000, 100'000, 3'700'000'000, 3'700'033'333};
  for (const int64_t us : times_us)
    ASSERT_TRUE(
        writer->write(testing::smooth_image(64, 48, 1), std::chrono::microseconds(us)).ok());
  ASSERT_TRUE(writer->close().ok());
  auto reader = VideoReader::open(directory / "a.mp4", {});
  ASSERT_TRUE(reader.ok()) << reader.status().to_string();
  const auto [frames, end] = testing::read_all(*reader);
  ASSERT_TRUE(end.ok()) << end.to_string();
  ASSERT_EQ(frames.size(), times_us.size());
  for (size_t i = 0; i < frames.size(); ++i)
    EXPECT_NEAR(to_seconds(frames[i].time), 1e-6 * static_cast<double>(times_us[i]), 1.2e-5) << i;
}

TEST(VideoWriter, GivesEqualBytesForEqualImages) {
  const TemporaryDirectory directory;
  const VideoWriter::Options options{.width = 64, .height = 48};
  ASSERT_TRUE(testing::write_video(directory / "a.mp4", 30, options).ok());
  ASSERT_TRUE(testing::write_video(directory / "b.mp4", 30, options).ok());
  EXPECT_TRUE(testing::content_of(directory / "a.mp4") == testing::content_of(directory / "b.mp4"));
}

TEST(VideoWriter, PutsTheIndexFirst) {
  const TemporaryDirectory directory;
  ASSERT_TRUE(testing::write_video(directory / "a.mp4", 5, {.width = 64, .height = 48}).ok());
  const std::string bytes = testing::content_of(directory / "a.mp4");
  EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));
}

TEST(VideoWriter, NotesTheTimeOfRecording) {
  const TemporaryDirectory directory;
  const Time created = *parse_time("2022-02-18 13:06:56");
  ASSERT_TRUE(
      testing::write_video(directory / "a.mp4", 2, {.width = 64, .height = 48, .created = created})
          .ok());
  ASSERT_TRUE(testing::write_video(directory / "b.mp4", 2, {.width = 64, .height = 48}).ok());
  EXPECT_EQ(VideoReader::open(directory / "a.mp4", {})->info().created, created);
  EXPECT_EQ(VideoReader::open(directory / "b.mp4", {})->info().created, std::nullopt);
}

TEST(VideoWriter, LeavesNothingWithoutClose) {
  const TemporaryDirectory directory;
  {
    auto writer = VideoWriter::create(directory / "a.mp4", {.width = 64, .height = 48});
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE(writer->write(testing::smooth_image(64, 48, 0)).ok());
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory / "."));
}

TEST(VideoWriter, RejectsAnImageOfAnotherShape) {
  const TemporaryDirectory directory;
  auto writer = VideoWriter::create(directory / "a.mp4", {.width = 64, .height = 48});
  ASSERT_TRUE(writer.ok());
  const Status status = writer->write(testing::smooth_image(48, 64, 0));
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_NE(status.message().find("needs uint8 [48, 64, 3]"), std::string::npos)
      << status.message();
}

TEST(VideoWriter, RejectsOptionsThatCannotBe) {
  const TemporaryDirectory directory;
  const VideoWriter::Options good{.width = 64, .height = 48};
  auto odd = good, slow = good, bad_crf = good, bad_preset = good, small = good;
  odd.width = 63;
  slow.rate_denominator = 0;
  bad_crf.crf = 52;
  bad_preset.preset = "hasty";
  small.height = 0;
  for (const VideoWriter::Options& options : {odd, slow, bad_crf, bad_preset, small})
    EXPECT_EQ(VideoWriter::create(directory / "a.mp4", options).status().code(),
              StatusCode::kInvalidArgument);
  EXPECT_TRUE(std::filesystem::is_empty(directory / "."));
}

TEST(VideoWriter, SaysWhereItCannotWrite) {
  const auto writer = VideoWriter::create("/nowhere/a.mp4", {.width = 64, .height = 48});
  EXPECT_EQ(writer.status().code(), StatusCode::kUnavailable);
  EXPECT_NE(writer.status().message().find("/nowhere/a.mp4"), std::string::npos);
}

}  // namespace
}  // namespace engram::datasets
