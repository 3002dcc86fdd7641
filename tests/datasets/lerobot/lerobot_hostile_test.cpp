// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>

#include "tests/datasets/lerobot/lerobot_folder.h"

namespace engram::datasets {
namespace {

/// Files that are truncated, empty, mislabelled or made to harm: every error says which file and
/// where, what was found and what was needed.
class LerobotHostileTest : public testing::LerobotFolder {
 protected:
  void SetUp() override { write_v3(); }

  /// Reads with another info.json.
  Status read_info(std::string_view text) {
    write("meta/info.json", text);
    return read();
  }
  Status read_changed(const std::string& name, const std::string& from, const std::string& to) {
    const std::string before = testing::content_of(folder_ / name);
    change(name, from, to);
    const Status status = read();
    write(name, before);
    return status;
  }
};

constexpr auto kInvalid = StatusCode::kInvalidArgument;
constexpr const char* kInfoFile = "meta/info.json";

TEST_F(LerobotHostileTest, InfoThatIsNoObject) {
  EXPECT_FAILS(read_info(""), kInvalid, "info.json': is empty, needs a JSON object");
  EXPECT_FAILS(read_info("[1]"), kInvalid, "info.json': found array, needs a JSON object");
  EXPECT_FAILS(read_info("{"), kInvalid, "found no JSON");
  EXPECT_FAILS(read_info(std::string(100'000, '[')), kInvalid, "found no JSON");
  std::filesystem::remove(folder_ / kInfoFile);
  EXPECT_FAILS(read(), StatusCode::kNotFound, "info.json");
  std::filesystem::create_directory(folder_ / kInfoFile);
  EXPECT_FAILS(read(), kInvalid, "is no file");
}

TEST_F(LerobotHostileTest, InfoWithWrongNumbers) {
  EXPECT_FAILS(read_changed(kInfoFile, "\"v3.0\"", "\"v9.0\""), kInvalid,
               "found \"v9.0\" as 'codebase_version', needs v2.0");
  for (const std::string fps : {"-10", "0", "1e-300", "1e300", "\"ten\"", "null", "[10]"})
    EXPECT_FAILS(read_changed(kInfoFile, "\"fps\": 10", "\"fps\": " + fps), kInvalid, "as 'fps'");
  for (const std::string size : {"0", "-1", "1.5"})
    EXPECT_FAILS(read_changed(kInfoFile, "1000,", size + ","), kInvalid,
                 "found " + size + " as 'chunks_size', needs 1 or more");
  for (const std::string shape : {"[-1]", "[0]", "[1000000, 1000000]", "7", "[\"a\"]"})
    EXPECT_FAILS(read_changed(kInfoFile, "\"shape\": [2]", "\"shape\": " + shape), kInvalid,
                 "'observation.state'");
  EXPECT_FAILS(read_changed(kInfoFile, "\"features\": {", "\"features\": 7, \"x\": {"), kInvalid,
               "found 7 as 'features'");
}

TEST_F(LerobotHostileTest, PathsThatLeadOutOfTheFolder) {
  for (const std::string path : {"/etc/passwd", "../other/{file_index}", "a/../../b", ""})
    EXPECT_FAILS(
        read_changed(kInfoFile, "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet", path),
        kInvalid, "as 'data_path', needs a path inside of the data set");
  EXPECT_FAILS(read_changed(kInfoFile, "videos/{video_key}", "/videos/{video_key}"), kInvalid,
               "as 'video_path'");
  // A feature whose name is a path.
  change(kInfoFile, "observation.images.front", "/../../../etc");
  change(kEpisodes, kEpisodeColumns,
         "episode_index,tasks,length,data/chunk_index,data/file_index,dataset_from_index,"
         "dataset_to_index,videos//../../../etc/chunk_index,videos//../../../etc/file_index,"
         "videos//../../../etc/from_timestamp,videos//../../../etc/to_timestamp\n");
  EXPECT_FAILS(read(), kInvalid, "needs one inside of the folder");
}

TEST_F(LerobotHostileTest, LinksOutOfTheFolder) {
  const ScratchDirectory elsewhere;
  std::filesystem::rename(folder_ / kVideo, elsewhere / "video.mp4");
  std::filesystem::create_symlink(elsewhere / "video.mp4", folder_ / kVideo);
  EXPECT_FAILS(read(), kInvalid, "is a link to");
  std::filesystem::remove(folder_ / kVideo);
  ASSERT_EQ(::mkfifo((folder_ / kVideo).c_str(), 0600), 0);
  EXPECT_FAILS(read(), kInvalid, "is no file");
}

TEST_F(LerobotHostileTest, LinksIntoTheCacheOfTheHub) {
  const ScratchDirectory cache;
  std::filesystem::create_directories(cache / "blobs");
  std::filesystem::create_directories(cache / "snapshots");
  std::filesystem::rename(folder_ / kTable, cache / "blobs/0123");
  std::filesystem::create_symlink("../../../../blobs/0123", folder_ / kTable);
  std::filesystem::copy(
      folder_.path(), cache / "snapshots/abc",
      std::filesystem::copy_options::recursive | std::filesystem::copy_options::copy_symlinks);
  EXPECT_OK(make_lerobot_format()->open(cache / "snapshots/abc", {}));
  auto reader = make_lerobot_format()->open(cache / "snapshots/abc", {});
  ASSERT_OK(reader);
  EXPECT_OK((*reader)->next());
}

TEST_F(LerobotHostileTest, EpisodesThatContradict) {
  EXPECT_FAILS(read_changed(kEpisodes, "1,Wave.,3", "1,Wave.,-3"), kInvalid,
               "file-000.csv': row 2, column 'length': found '-3'");
  EXPECT_FAILS(read_changed(kEpisodes, "1,Wave.,3", "1,Wave.,4"), kInvalid,
               "row 2, column 'dataset_to_index': found '7', needs 4 and a length of 4");
  EXPECT_FAILS(read_changed(kEpisodes, "1,Wave.,3", "0,Wave.,3"), kInvalid,
               "episode 0 is there twice");
  EXPECT_FAILS(read_changed(kEpisodes, "0.4,0.7", "0.7,0.4"), kInvalid,
               "needs a time behind 'from_timestamp'");
  EXPECT_FAILS(read_changed(kEpisodes, "0.4,0.7", "nan,0.7"), kInvalid, "found 'nan'");
  EXPECT_FAILS(read_changed(kEpisodes, "0.4,0.7", "1e300,0.7"), kInvalid, "needs seconds");
  EXPECT_FAILS(read_changed(kEpisodes, "0.4,0.7", "0.4"), kInvalid, "row 2 has 10 cells, needs 11");
  EXPECT_FAILS(read_changed(kEpisodes, ",length,", ",lengths,"), kInvalid,
               "needs one called 'length'");
  EXPECT_FAILS(read_changed(kEpisodes, "1,Wave.,3", "1,Wave.,1000000000000000000"), kInvalid,
               "column 'dataset_to_index'");
  write(kEpisodes, "");
  EXPECT_FAILS(read(), kInvalid, "is empty, needs a line with the names");
  std::filesystem::remove(folder_ / kEpisodes);
  EXPECT_FAILS(read(), StatusCode::kNotFound, "has no chunk-000/file-000.parquet");
}

TEST_F(LerobotHostileTest, TablesThatDoNotFit) {
  EXPECT_FAILS(read_changed(kTable, "timestamp", "time"), kInvalid, "needs one called 'timestamp'");
  EXPECT_FAILS(read_changed(kTable, "0.1,1,1,5", "nan,1,1,5"), kInvalid,
               "row 6, column 'timestamp': found 'nan'");
  EXPECT_FAILS(read_changed(kTable, "0.1,1,1,5", "-1,1,1,5"), kInvalid, "found '-1'");
  EXPECT_FAILS(read_changed(kTable, "0.2,2,1,6", "0.05,2,1,6"), kInvalid,
               "row 7, column 'timestamp': found '0.05', needs a time behind");
  EXPECT_FAILS(read_changed(kTable, "0,0.5,2,0.1", "0,x,2,0.1"), kInvalid,
               "row 1, column 'observation.state.1': found 'x', needs a number");
  EXPECT_FAILS(read_changed(kTable, "0.1,1,1,5,0", "0.1,1,1,5,9"), kInvalid,
               "found '9', which the tasks do not have");
  EXPECT_FAILS(read_changed(kTable, "0.1,1,1,5", "0.1,1,2,5"), StatusCode::kDataLoss,
               "found 1 rows of episode_000001, needs 3");
  EXPECT_FAILS(read_changed(kTable, "episode_index", "episode"), kInvalid,
               "needs one called 'episode_index'");
  std::filesystem::resize_file(folder_ / kTable, 200);
  EXPECT_FAILS(read(), kInvalid, "file-000.csv': row 4 has");
  write(kTable, "");
  EXPECT_FAILS(read(), kInvalid, "file-000.csv': is empty");
}

TEST_F(LerobotHostileTest, NumbersThatAreNoneAreKept) {
  change(kTable, "0,0.5,2,0.1", "0,nan,inf,0.1");
  ASSERT_OK(read());
  EXPECT_TRUE(std::isnan(
      value(0, "RobotState/Proprioception/robot/state").at("elbow")->as_number().value()));
}

TEST_F(LerobotHostileTest, VideosThatAreTexts) {
  write(kVideo, "This is no video.\n");
  EXPECT_FAILS(read(), kInvalid, "file-000.mp4': ");
  write(kVideo, "");
  EXPECT_FAILS(read(), kInvalid, "file-000.mp4': ");
  std::filesystem::remove(folder_ / kVideo);
  EXPECT_FAILS(read(), StatusCode::kNotFound, "file-000.mp4': there is no such file");
}

TEST_F(LerobotHostileTest, EpisodesOfV2) {
  change(kInfoFile, "v3.0", "v2.1");
  EXPECT_FAILS(read(), StatusCode::kNotFound, "episodes.jsonl");
  const std::string table = testing::content_of(folder_ / kTable);
  write(kTable, table.substr(0, table.find("4,0.5")));
  const auto lines = [&](std::string_view text) {
    write("meta/episodes.jsonl", text);
    return read();
  };
  EXPECT_FAILS(lines("{\"episode_index\": 0, \"length\": 4}\n{\"episode_index\": 0}\n"), kInvalid,
               "line 2: needs an 'episode_index' and a 'length'");
  EXPECT_FAILS(lines("{\"episode_index\": -1, \"length\": 4}"), kInvalid, "line 1");
  EXPECT_FAILS(lines("{\"episode_index\": 1e400, \"length\": 4}"), kInvalid, "line 1");
  EXPECT_FAILS(lines("\n[]\n"), kInvalid, "line 2: found array, needs a JSON object");
  EXPECT_FAILS(lines(std::string(2'000'000, ' ')), kInvalid, "line 1 has more than");
  EXPECT_FAILS(lines("{\"episode_index\": 0, \"length\": 1000000000000000000}"),
               StatusCode::kDataLoss, "found 4 rows of episode_000000, needs 1000000000000000000");
  EXPECT_FAILS(lines("{\"episode_index\": 0, \"length\": 3}"), StatusCode::kDataLoss,
               "found more than 3 rows");
  EXPECT_FAILS(lines(""), StatusCode::kNotFound, "of its 0 episodes no table is there");
}

}  // namespace
}  // namespace engram::datasets
