// SPDX-License-Identifier: Apache-2.0
#include "datasets/media/video_reader.h"

#include <gtest/gtest.h>

#include "tests/datasets/fixtures.h"

namespace engram::datasets {
namespace {

using testing::TemporaryDirectory;

constexpr VideoWriter::Options kVideo{.width = 128, .height = 96, .crf = 10};

/// An image of flat colour patches, 8 x 8 of them, whose averages are easy to say.
idf::NdArray patches(int width, int height) {
  std::vector<uint8_t> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int column = 8 * x / width, row = 8 * y / height;
      for (const int value : {40 + 20 * column, 200 - 20 * row, 60 + 10 * (column + row)})
        pixels.push_back(static_cast<uint8_t>(value));
    }
  return idf::NdArray::take({height, width, 3}, std::move(pixels));
}

std::filesystem::path write_patches(const TemporaryDirectory& directory) {
  auto writer = VideoWriter::create(directory / "patches.mp4",
                                    {.width = 128, .height = 64, .crf = 1, .keeps_chroma = true});
  EXPECT_TRUE(writer.ok());
  EXPECT_TRUE(writer->write(patches(128, 64)).ok());
  EXPECT_TRUE(writer->close().ok());
  return directory / "patches.mp4";
}

idf::NdArray first_image(const std::filesystem::path& path, const VideoReader::Options& options) {
  auto reader = VideoReader::open(path, options);
  EXPECT_TRUE(reader.ok()) << reader.status().to_string();
  auto frame = reader->next();
  EXPECT_TRUE(frame.ok() && *frame) << frame.status().to_string();
  return (**frame).image;
}

TEST(VideoReader, AveragesAreasWhenShrinking) {
  const TemporaryDirectory directory;
  const auto path = write_patches(directory);
  const idf::NdArray small = first_image(path, {.width = 8, .height = 8});
  EXPECT_GT(testing::psnr_db(small, patches(8, 8)), 44);
}

TEST(VideoReader, CutsTheCentreSquareBeforeScaling) {
  const TemporaryDirectory directory;
  const auto path = write_patches(directory);
  const idf::NdArray whole = first_image(path, {});
  const idf::NdArray square = first_image(path, {.crops_square = true});
  ASSERT_EQ(square.shape(), (idf::Shape{64, 64, 3}));
  for (size_t y = 0; y < 64; ++y)
    for (size_t i = 0; i < 64 * 3; ++i)
      ASSERT_EQ(square.values<uint8_t>()[y * 64 * 3 + i],
                whole.values<uint8_t>()[y * 128 * 3 + 32 * 3 + i]);
  EXPECT_EQ(first_image(path, {.width = 16, .height = 8, .crops_square = true}).shape(),
            (idf::Shape{8, 16, 3}));
}

TEST(VideoReader, KeepsTheShapeWhereOneSideIsGiven) {
  const TemporaryDirectory directory;
  const auto path = write_patches(directory);
  EXPECT_EQ(first_image(path, {.width = 32}).shape(), (idf::Shape{16, 32, 3}));
  EXPECT_EQ(first_image(path, {.height = 128}).shape(), (idf::Shape{128, 256, 3}));
}

TEST(VideoReader, GivesTheSameFramesWithAnyNumberOfThreads) {
  const TemporaryDirectory directory;
  ASSERT_TRUE(testing::write_video(directory / "a.mp4", 30, kVideo).ok());
  auto one = VideoReader::open(directory / "a.mp4", {.threads = 1});
  auto four = VideoReader::open(directory / "a.mp4", {.threads = 4});
  const auto a = testing::read_all(*one), b = testing::read_all(*four);
  ASSERT_EQ(a.frames.size(), 30u);
  ASSERT_EQ(b.frames.size(), 30u);
  for (size_t i = 0; i < a.frames.size(); ++i)
    EXPECT_TRUE(a.frames[i].image == b.frames[i].image) << i;
}

TEST(VideoReader, ConvertsFramesWhenTheyAreAskedFor) {
  const TemporaryDirectory directory;
  ASSERT_TRUE(testing::write_video(directory / "a.mp4", 8, {.width = 64, .height = 48}).ok());
  const VideoReader::Options options{.width = 16, .height = 16, .crops_square = true};
  auto whole = *VideoReader::open(directory / "a.mp4", options);
  const auto [frames, status] = testing::read_all(whole);
  ASSERT_EQ(frames.size(), 8u);

  auto reader = *VideoReader::open(directory / "a.mp4", options);
  EXPECT_EQ(reader.image_shape(), (idf::Shape{16, 16, 3}));
  std::vector<DecodedFrame> decoded;
  while (auto frame = *reader.decode()) decoded.push_back(*std::move(frame));
  ASSERT_EQ(decoded.size(), 8u);
  for (size_t i = decoded.size(); i-- > 0;) {
    EXPECT_EQ(decoded[i].time, frames[i].time);
    EXPECT_EQ(*reader.convert(decoded[i]), frames[i].image) << i;
    EXPECT_GE(decoded[i].bytes(), 64u * 48 * 3 / 2);
  }
  // Once more: converting changes nothing.
  EXPECT_EQ(*reader.convert(decoded[0]), frames[0].image);
  EXPECT_TRUE(decoded[3].repeats(decoded[3]));
  EXPECT_FALSE(decoded[3].repeats(decoded[4]));
}

TEST(VideoReader, StaysAtTheEnd) {
  const TemporaryDirectory directory;
  ASSERT_TRUE(testing::write_video(directory / "a.mp4", 2, kVideo).ok());
  auto reader = VideoReader::open(directory / "a.mp4", {});
  EXPECT_EQ(testing::read_all(*reader).frames.size(), 2u);
  const auto after = reader->next();
  ASSERT_TRUE(after.ok());
  EXPECT_FALSE(after->has_value());
}

TEST(VideoReader, DeliversATruncatedVideoUpToTheBreakAndSaysWhere) {
  const TemporaryDirectory directory;
  ASSERT_TRUE(testing::write_video(directory / "a.mp4", 60, kVideo).ok());
  const std::string bytes = testing::content_of(directory / "a.mp4");
  const auto path = directory.write("torn.mp4", bytes.substr(0, bytes.size() * 6 / 10));
  auto reader = VideoReader::open(path, {});
  ASSERT_TRUE(reader.ok()) << reader.status().to_string();
  const auto [frames, end] = testing::read_all(*reader);
  EXPECT_EQ(end.code(), StatusCode::kDataLoss);
  EXPECT_NE(end.message().find("torn.mp4"), std::string::npos) << end.message();
  ASSERT_GT(frames.size(), 10u);
  ASSERT_LT(frames.size(), 60u);
  const std::string reached = fmt::format("after {:.6f} s", to_seconds(frames.back().time));
  EXPECT_NE(end.message().find(reached), std::string::npos) << end.message();
  EXPECT_EQ(reader->next().status().code(), StatusCode::kDataLoss) << "it stays broken";
}

TEST(VideoReader, CountsFramesThatAreDamaged) {
  const TemporaryDirectory directory;
  ASSERT_TRUE(testing::write_video(directory / "a.mp4", 60, kVideo).ok());
  std::string bytes = testing::content_of(directory / "a.mp4");
  const size_t media = bytes.find("mdat");
  ASSERT_NE(media, std::string::npos);
  const size_t middle = media + (bytes.size() - media) / 2;
  for (size_t i = 0; i < 400; ++i) bytes[middle + i] = static_cast<char>(37 * i + 11);
  auto reader = VideoReader::open(directory.write("b.mp4", bytes), {});
  ASSERT_TRUE(reader.ok()) << reader.status().to_string();
  const auto [frames, end] = testing::read_all(*reader);
  EXPECT_GT(reader->damaged_frames(), 0u);
  EXPECT_GT(frames.size(), 30u);
}

TEST(VideoReader, SurvivesAnyDamage) {
  const TemporaryDirectory directory;
  ASSERT_TRUE(testing::write_video(directory / "a.mp4", 20, {.width = 64, .height = 48}).ok());
  const std::string whole = testing::content_of(directory / "a.mp4");
  uint32_t state = 7;
  for (int round = 0; round < 60; ++round) {
    std::string bytes = whole;
    for (int i = 0; i < 6; ++i) {
      state = state * 1664525 + 1013904223;
      bytes[(state >> 8) % bytes.size()] = static_cast<char>(state >> 3);
    }
    auto reader = VideoReader::open(directory.write("b.mp4", bytes), {});
    if (reader.ok()) testing::read_all(*reader);
  }
}

TEST(VideoReader, RejectsWhatIsNoVideo) {
  const TemporaryDirectory directory;
  EXPECT_EQ(VideoReader::open(directory / "none.mp4", {}).status().code(), StatusCode::kNotFound);
  EXPECT_EQ(VideoReader::open(directory / ".", {}).status().code(), StatusCode::kInvalidArgument);
  for (const char* name : {"a.mp4", "a.txt", "a.csv"})
    EXPECT_EQ(VideoReader::open(directory.write(name, "timestamp,a\n0,1\n"), {}).status().code(),
              StatusCode::kInvalidArgument)
        << name;
  EXPECT_EQ(VideoReader::open(directory.write("empty.mp4", ""), {}).status().code(),
            StatusCode::kInvalidArgument);
}

TEST(VideoReader, RejectsOptionsThatCannotBe) {
  for (const VideoReader::Options& options :
       {VideoReader::Options{.width = -1}, VideoReader::Options{.height = 1 << 20},
        VideoReader::Options{.threads = 0}})
    EXPECT_EQ(VideoReader::open("a.mp4", options).status().code(), StatusCode::kInvalidArgument);
}

TEST(VideoReader, ReadsTheRealAv1EpisodesWholeWithExactTimes) {
  const auto data = testing::recordings();
  if (data.empty()) GTEST_SKIP() << "no recordings: set ENGRAM_RECORDINGS";
  const std::vector<std::pair<const char*, size_t>> episodes{
      {"04", 357}, {"05", 368}, {"10", 290}, {"11", 421}, {"12", 372}};
  for (const auto& [number, count] : episodes) {
    auto reader = VideoReader::open(data / "g1/videos/chunk-000/observation.images.cam_high" /
                                        fmt::format("episode_0000{}.mp4", number),
                                    {.width = 32, .height = 32, .crops_square = true});
    ASSERT_TRUE(reader.ok()) << reader.status().to_string();
    EXPECT_EQ(reader->info().codec, "av1");
    EXPECT_EQ(reader->info().width, 640);
    EXPECT_EQ(reader->info().rate_hz, 30);
    EXPECT_EQ(reader->info().approximate_frames, count);
    const auto [frames, end] = testing::read_all(*reader);
    EXPECT_TRUE(end.ok()) << end.to_string();
    EXPECT_EQ(reader->damaged_frames(), 0u);
    ASSERT_EQ(frames.size(), count);
    for (size_t i = 0; i < count; ++i)
      ASSERT_EQ(frames[i].time.count(), std::llround(static_cast<double>(i) * 1e9 / 30)) << i;
  }
}

}  // namespace
}  // namespace engram::datasets
