// SPDX-License-Identifier: Apache-2.0
#include <stdlib.h>

#include "ltm/codec/png.h"
#include "tests/datasets/lerobot/lerobot_folder.h"

namespace engram::datasets {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr const char* kState = "RobotState/Proprioception/robot/state";
constexpr const char* kFront = "Vision/RGB/robot/front";
constexpr const char* kTask = "Tasks/Feedback/robot/task";

class LerobotV3Test : public testing::LerobotFolder {
 protected:
  /// The frame of the video that a moment's image is nearest to.
  int frame_of(size_t moment) const {
    const auto image = value(moment, kFront).at("image")->get<idf::NdArray>();
    int best = -1;
    double best_db = 0;
    for (int i = 0; i < 15; ++i)
      if (const double db = testing::psnr_db(image, testing::smooth_image(64, 48, i));
          db > best_db) {
        best_db = db;
        best = i;
      }
    return best;
  }
};

TEST_F(LerobotV3Test, CutsEpisodesOutOfSharedTablesAndVideos) {
  write_v3();
  ASSERT_OK(read());
  ASSERT_EQ(moments_.size(), 12u);
  std::vector<std::pair<size_t, std::string>> begun;
  for (size_t i = 0; i < moments_.size(); ++i) {
    EXPECT_EQ(frame_of(i), static_cast<int>(i));
    EXPECT_EQ(value(i, kState).at("shoulder")->as_number(), static_cast<double>(i));
    if (moments_[i].begins) begun.emplace_back(i, moments_[i].begins->name);
  }
  EXPECT_THAT(begun, ElementsAre(Pair(0, "episode_000000"), Pair(4, "episode_000001"),
                                 Pair(7, "episode_000002")));
  // 0.4 s, a gap of 10 s.
  EXPECT_EQ(to_ns(moments_[4].begins->start), 10'400'000'000);
  EXPECT_EQ(moments_[7].begins->attributes.find("tasks")->get<idf::List>().size(), 2u);
  EXPECT_THAT(report_.not_carried, IsEmpty());
  EXPECT_EQ(report_.damaged, 0u);
  const auto action = value(5, "Skills/Commands/robot/action").at("values")->get<idf::NdArray>();
  EXPECT_THAT(action.values<float>(), ElementsAre(2.0f, 0.1f));
}

TEST_F(LerobotV3Test, SaysWhichOfSeveralTasksTheRobotIsAt) {
  write_v3();
  ASSERT_OK(read());
  std::vector<std::pair<size_t, std::string>> tasks;
  for (size_t i = 0; i < moments_.size(); ++i)
    if (const idf::Data task = value(i, kTask); task.at("text") != nullptr)
      tasks.emplace_back(i, task.at("text")->get<std::string>());
  EXPECT_THAT(tasks, ElementsAre(Pair(0, "Wave."), Pair(4, "Wave."), Pair(7, "Wave."),
                                 Pair(10, "Bow, deeply.")));
}

TEST_F(LerobotV3Test, TakesTheEpisodesThatAreAskedFor) {
  write_v3();
  ASSERT_OK(read({.episodes = {"2"}}));
  ASSERT_EQ(moments_.size(), 5u);
  EXPECT_EQ(frame_of(0), 7);
  EXPECT_EQ(frame_of(4), 11);
  EXPECT_THAT(report_.not_carried, IsEmpty());
}

TEST_F(LerobotV3Test, ReadsEpisodesThatLieInAnotherOrder) {
  write_v3();
  // The first episode is what was the last one.
  change(kEpisodes, "0,\"[\"\"Wave.\"\"]\"", "3,\"[\"\"Wave.\"\"]\"");
  std::string table = testing::content_of(folder_ / kTable);
  for (const std::string index : {"0", "1", "2", "3"}) {
    const size_t at = table.find("," + index + ",0," + index + ",0\n");
    ASSERT_NE(at, std::string::npos);
    table[at + 3] = '3';
  }
  write(kTable, table);
  ASSERT_OK(read());
  ASSERT_EQ(moments_.size(), 12u);
  EXPECT_EQ(frame_of(0), 4);
  EXPECT_EQ(frame_of(8), 0);
  EXPECT_EQ(frame_of(11), 3);
}

TEST_F(LerobotV3Test, CountsRowsAndFramesThatDoNotGoTogether) {
  write_v3();
  write_video(kVideo, 11);
  ASSERT_OK(read());
  EXPECT_THAT(report_.not_carried, ElementsAre(Pair("rows without a frame", 1)));
  // Every step of the episode in the middle is twice as long.
  change(kEpisodes, "0.4,0.7", "0.4,1");
  change(kTable, "0.1,1,1,5", "0.2,1,1,5");
  change(kTable, "0.2,2,1,6", "0.4,2,1,6");
  ASSERT_OK(read({.episodes = {"1"}}));
  EXPECT_THAT(report_.not_carried, ElementsAre(Pair("frames without a row", 3)));
  EXPECT_EQ(frame_of(2), 8);
}

TEST_F(LerobotV3Test, AVideoThatEndsEarlyIsReadAsFarAsItGoes) {
  write_v3();
  std::string video = testing::content_of(folder_ / kVideo);
  ASSERT_OK(read());
  std::filesystem::resize_file(folder_ / kVideo, video.size() / 2);
  const Status status = read();
  // Where the index lies at the end, nothing can be read at all.
  if (status.ok())
    EXPECT_THAT(report_.truncated_at, HasSubstr("file-000.mp4"));
  else
    EXPECT_THAT(status.message(), HasSubstr("file-000.mp4"));
}

/// Tables as Parquet, with a stand-in for pyarrow: see stand_in/pyarrow/parquet.py.
class LerobotParquetTest : public LerobotV3Test {
 protected:
  void SetUp() override {
    ::setenv("PYTHONPATH", ENGRAM_SOURCE_DIR "/tests/datasets/lerobot/stand_in", 1);
    ::setenv("ENGRAM_PYTHON", "/usr/bin/python3", 1);
  }
  void TearDown() override {
    ::unsetenv("PYTHONPATH");
    ::unsetenv("ENGRAM_PYTHON");
  }

  static std::string png_hex(uint8_t grey) {
    const auto png = ltm::png_codec().encode(idf::NdArray::take<uint8_t>({1, 1, 1}, {grey}));
    EXPECT_OK(png);
    std::string hex;
    for (const std::byte byte : *png) hex += fmt::format("{:02x}", std::to_integer<int>(byte));
    return hex;
  }
};

TEST_F(LerobotParquetTest, ReadsTablesOfEpisodesTasksAndSteps) {
  write_v3();
  write("meta/tasks.parquet", "{\"task_index\": 0, \"__index_level_0__\": \"Wave.\"}\n");
  std::filesystem::remove(folder_ / "meta/tasks.csv");
  std::filesystem::remove(folder_ / kEpisodes);
  write("meta/episodes/chunk-000/file-000.parquet",
        R"({"episode_index": 0, "tasks": ["Wave."], "length": 2, "data/chunk_index": 0,)"
        R"( "data/file_index": 0, "videos/observation.images.front/chunk_index": 0,)"
        R"( "videos/observation.images.front/file_index": 0,)"
        R"( "videos/observation.images.front/from_timestamp": 0.3,)"
        R"( "videos/observation.images.front/to_timestamp": 0.5, "stats/action/min": [1, 2]})"
        "\n");
  std::filesystem::remove(folder_ / kTable);
  std::string rows;
  for (int i = 0; i < 600; ++i)
    rows += fmt::format(
        R"({{"observation.state": [{}, 0.1], "action": [1, null], "timestamp": {}, "episode_index": {}}})"
        "\n",
        i, 0.1 * (i % 2), i < 598 ? 7 : 0);
  write("data/chunk-000/file-000.parquet", rows);
  ASSERT_OK(read());
  ASSERT_EQ(moments_.size(), 2u);
  EXPECT_EQ(value(0, kState).at("shoulder")->as_number(), 598.0);
  EXPECT_EQ(frame_of(0), 3);
  EXPECT_EQ(frame_of(1), 4);
  EXPECT_THAT(report_.not_carried, ElementsAre(Pair("values with empty cells", 2)));
  EXPECT_EQ(streams_.size(), 3u);
}

TEST_F(LerobotParquetTest, ReadsImagesAndTextsOfV2) {
  write("meta/info.json",
        R"({"codebase_version": "v2.1", "fps": 10, "video_path": null,
 "data_path": "data/episode_{episode_index:06d}.parquet",
 "features": {"observation.images.front": {"dtype": "image", "shape": [1, 1, 1]},
  "next.done": {"dtype": "bool", "shape": [1], "names": null},
  "instruction": {"dtype": "string", "shape": [1], "names": null}}})");
  write("meta/episodes.jsonl", "{\"episode_index\": 0, \"length\": 3}\n");
  write(
      "data/episode_000000.parquet",
      fmt::format(
          R"({{"observation.images.front": {{"hex": "{}"}}, "timestamp": 0, "next.done": false, "instruction": "a, \"b\""}}
{{"observation.images.front": {{"hex": "89504e47"}}, "timestamp": 0.1, "next.done": true, "instruction": "c"}}
{{"observation.images.front": {{"hex": "{}"}}, "timestamp": 0.2, "next.done": true, "instruction": "d"}}
)",
          png_hex(7), png_hex(9)));
  ASSERT_OK(read());
  ASSERT_EQ(moments_.size(), 3u);
  EXPECT_EQ(*value(0, kFront).at("image"), idf::Data(idf::NdArray::take<uint8_t>({1, 1, 1}, {7})));
  EXPECT_EQ(*value(2, kFront).at("image"), idf::Data(idf::NdArray::take<uint8_t>({1, 1, 1}, {9})));
  EXPECT_EQ(report_.damaged, 1u);
  EXPECT_EQ(value(0, "Tasks/Feedback/robot/instruction").at("text")->get<std::string>(),
            "a, \"b\"");
  const auto done = value(1, "Tasks/Feedback/robot/done").at("values")->get<idf::NdArray>();
  EXPECT_THAT(done.values<uint8_t>(), ElementsAre(1));
}

TEST_F(LerobotParquetTest, SaysWhatPythonSaysOfAFileThatIsNoTable) {
  write_v3();
  std::filesystem::remove(folder_ / kTable);
  write("data/chunk-000/file-000.parquet", "no table\n");
  EXPECT_FAILS(read(), StatusCode::kUnavailable, "file-000.parquet' through pyarrow");
}

}  // namespace
}  // namespace engram::datasets
