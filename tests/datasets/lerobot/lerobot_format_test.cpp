// SPDX-License-Identifier: Apache-2.0
#include "datasets/lerobot/lerobot_format.h"

#include <gmock/gmock.h>

#include "tests/datasets/fixtures.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr int kSteps = 12;
constexpr const char* kCamera = "observation.images.front";

/// Two episodes of an arm with two joints, seen by one camera; a third one is not there.
class LerobotFormatTest : public ::testing::Test {
 protected:
  void SetUp() override {
    write("meta/info.json",
          R"({"codebase_version": "v2.1", "robot_type": "arm", "fps": 10, "chunks_size": 1000,
 "data_path": "data/chunk-{episode_chunk:03d}/episode_{episode_index:06d}.parquet",
 "video_path": "videos/chunk-{episode_chunk:03d}/{video_key}/episode_{episode_index:06d}.mp4",
 "features": {
  "observation.state": {"dtype": "float32", "shape": [2], "names": [["shoulder", "elbow"]]},
  "action": {"dtype": "float32", "shape": [2], "names": null},
  "next.reward": {"dtype": "float32", "shape": [1], "names": null},
  "observation.images.front": {"dtype": "video", "shape": [48, 64, 3]},
  "timestamp": {"dtype": "float32", "shape": [1]}}})");
    write("meta/episodes.jsonl",
          "{\"episode_index\": 0, \"tasks\": [\"Wave.\"], \"length\": 12}\n"
          "{\"episode_index\": 1, \"tasks\": [\"Wave.\"], \"length\": 12}\n"
          "{\"episode_index\": 1007, \"tasks\": [\"Wave.\"], \"length\": 12}\n");
    for (int episode = 0; episode < 2; ++episode) {
      std::string table =
          "timestamp,index,state.shoulder,state.elbow,action.0,action.1,next.reward\n";
      for (int i = 0; i < kSteps; ++i)
        table += fmt::format("{},{},{},{},{},{},{}\n", 0.1 * i, i, episode + 0.01 * i, 2.0, 3.5, i,
                             i == kSteps - 1 ? 1 : 0);
      write(fmt::format("data/chunk-000/episode_00000{}.csv", episode), table);
      const auto video =
          folder_ / fmt::format("videos/chunk-000/{}/episode_00000{}.mp4", kCamera, episode);
      std::filesystem::create_directories(video.parent_path());
      ASSERT_OK(
          testing::write_video(video, kSteps, {.width = 64, .height = 48, .rate_numerator = 10}));
    }
  }

  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    folder_.write(name, text);
  }

  Result<std::unique_ptr<RecordingReader>> open(const ReadingOptions& options = {}) {
    return format_->open(folder_.path(), options);
  }

  static std::vector<RecordingReader::Moment> all_of(RecordingReader& reader) {
    std::vector<RecordingReader::Moment> moments;
    while (true) {
      auto moment = reader.next();
      EXPECT_OK(moment);
      if (!moment.ok() || !*moment) break;
      moments.push_back(**std::move(moment));
    }
    return moments;
  }

  testing::TemporaryDirectory folder_;
  std::unique_ptr<const RecordingFormat> format_ = make_lerobot_format();
};

TEST_F(LerobotFormatTest, KnowsItsFolders) {
  EXPECT_TRUE(format_->recognises(folder_.path()));
  EXPECT_FALSE(format_->recognises(folder_ / "meta"));
  EXPECT_FALSE(format_->can_write());
}

TEST_F(LerobotFormatTest, ReadsEpisodesWithNamedJointsAndLinkedVideo) {
  ReadingOptions options;
  options.start = time_from_ns(1'000'000'000'000);
  auto reader = open(options);
  ASSERT_OK(reader);
  ASSERT_EQ((*reader)->streams().size(), 4u);
  const auto moments = all_of(**reader);
  ASSERT_EQ(moments.size(), 2u * kSteps);
  ASSERT_TRUE(moments[0].begins && moments[kSteps].begins);
  EXPECT_FALSE(moments[1].begins);
  EXPECT_EQ(moments[0].begins->name, "episode_000000");
  EXPECT_EQ(moments[0].begins->start, *options.start);
  // 1.2 s and a gap of 10 s.
  EXPECT_EQ(moments[kSteps].begins->start, *options.start + std::chrono::milliseconds(11'200));
  std::map<std::string, idf::Data> values;
  for (const ltm::EntityUpdate& update : moments[kSteps + 3].commit.updates)
    values[update.entity.to_string()] = update.instances[0].data;
  const idf::Data& state = values.at("RobotState/Proprioception/robot/state");
  EXPECT_EQ(state.at("shoulder")->as_number(), 1.03);
  EXPECT_EQ(state.at("elbow")->as_number(), 2.0);
  const std::string camera = state.at("camera")->get<std::string>();
  EXPECT_THAT(camera, HasSubstr("Vision/RGB/robot/front/1970-01-01 00:16:51.5"));
  const idf::NdArray action =
      values.at("Skills/Commands/robot/action").at("values")->get<idf::NdArray>();
  EXPECT_THAT(action.values<float>(), ElementsAre(3.5f, 3.0f));
  EXPECT_EQ(values.count("Tasks/Feedback/robot/reward"), 1u);
  const idf::Data& image = values.at("Vision/RGB/robot/front");
  EXPECT_THAT(image.at("image")->get<idf::NdArray>().shape(), ElementsAre(48, 64, 3));
  EXPECT_THAT(image.at("state")->get<std::string>(),
              HasSubstr("RobotState/Proprioception/robot/state/"));
  EXPECT_THAT((*reader)->report().not_carried,
              ElementsAre(::testing::Pair("episodes whose files are not there", 1)));
}

TEST_F(LerobotFormatTest, TakesTheEpisodesThatAreAskedFor) {
  ReadingOptions options;
  options.episodes = {"1"};
  auto reader = open(options);
  ASSERT_OK(reader);
  const auto moments = all_of(**reader);
  ASSERT_EQ(moments.size(), static_cast<size_t>(kSteps));
  EXPECT_EQ(moments[0].begins->name, "episode_000001");
  options.episodes = {"1", "unicorn"};
  EXPECT_FAILS(open(options), StatusCode::kNotFound, "'unicorn'");
}

TEST_F(LerobotFormatTest, CountsFramesAndRowsThatDoNotGoTogether) {
  const auto video = [&](int episode) {
    return folder_ / fmt::format("videos/chunk-000/{}/episode_00000{}.mp4", kCamera, episode);
  };
  const VideoWriter::Options options{.width = 64, .height = 48, .rate_numerator = 10};
  ASSERT_OK(testing::write_video(video(0), kSteps - 2, options));
  ASSERT_OK(testing::write_video(video(1), kSteps + 3, options));
  auto reader = open();
  ASSERT_OK(reader);
  EXPECT_EQ(all_of(**reader).size(), 2u * kSteps);
  const auto& met = (*reader)->report().not_carried;
  EXPECT_EQ(met.at("rows without a frame"), 2u);
  EXPECT_EQ(met.at("frames without a row"), 3u);
}

TEST_F(LerobotFormatTest, SaysHowParquetIsRead) {
  std::filesystem::rename(folder_ / "data/chunk-000/episode_000000.csv",
                          folder_ / "data/chunk-000/episode_000000.parquet");
  const std::string python = folder_ / "python";
  std::ofstream(python) << "#!/bin/sh\necho 'engram: no pyarrow'\n";
  std::filesystem::permissions(python, std::filesystem::perms::owner_all);
  ::setenv("ENGRAM_PYTHON", python.c_str(), 1);
  auto reader = open();
  ASSERT_OK(reader);
  EXPECT_FAILS((*reader)->next(), StatusCode::kFailedPrecondition, "pip install pyarrow");
  ::unsetenv("ENGRAM_PYTHON");
}

TEST(Lerobot, ReadsAHumanoidsEpisodesWhole) {
  const auto recordings = testing::recordings();
  if (recordings.empty()) GTEST_SKIP() << "needs recordings";
  ReadingOptions options;
  options.episodes = {"10"};
  auto reader = make_lerobot_format()->open(recordings / "g1", options);
  ASSERT_OK(reader);
  int moments = 0;
  while (true) {
    const auto moment = (*reader)->next();
    ASSERT_OK(moment);
    if (!*moment) break;
    EXPECT_EQ((*moment)->commit.updates.size(), 3u);
    ++moments;
  }
  EXPECT_EQ(moments, 290);
}

}  // namespace
}  // namespace engram::datasets
