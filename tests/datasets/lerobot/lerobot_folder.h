// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "datasets/lerobot/lerobot_format.h"
#include "tests/datasets/fixtures.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets::testing {

/// A folder that a data set is written into.
class LerobotFolder : public ::testing::Test {
 protected:
  static constexpr const char* kInfo =
      R"({"codebase_version": "v3.0", "robot_type": "arm", "fps": 10, "chunks_size": 1000,
 "total_episodes": 1000000000000000000,
 "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
 "video_path": "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4",
 "features": {
  "observation.state": {"dtype": "float32", "shape": [2], "names": ["shoulder", "elbow"]},
  "action": {"dtype": "float32", "shape": [2], "names": null},
  "observation.images.front": {"dtype": "video", "shape": [48, 64, 3]},
  "timestamp": {"dtype": "float32", "shape": [1]}}})";
  static constexpr const char* kEpisodeColumns =
      "episode_index,tasks,length,data/chunk_index,data/file_index,dataset_from_index,"
      "dataset_to_index,videos/observation.images.front/chunk_index,"
      "videos/observation.images.front/file_index,videos/observation.images.front/from_timestamp,"
      "videos/observation.images.front/to_timestamp\n";
  static constexpr const char* kEpisodes = "meta/episodes/chunk-000/file-000.csv";
  static constexpr const char* kTable = "data/chunk-000/file-000.csv";
  static constexpr const char* kVideo = "videos/observation.images.front/chunk-000/file-000.mp4";

  /// Three episodes of 4, 3 and 5 steps, all in one table and one video of 12 frames.
  void write_v3() {
    write("meta/info.json", kInfo);
    write("meta/tasks.csv", "task_index,task\n0,Wave.\n1,\"Bow, deeply.\"\n");
    write(kEpisodes, std::string(kEpisodeColumns) +
                         "0,\"[\"\"Wave.\"\"]\",4,0,0,0,4,0,0,0.0,0.4\n"
                         "1,Wave.,3,0,0,4,7,0,0,0.4,0.7\n"
                         "2,\"[\"\"Wave.\"\", \"\"Bow, deeply.\"\"]\",5,0,0,7,12,0,0,0.7,1.2\n");
    std::string table =
        "observation.state.0,observation.state.1,action.0,action.1,timestamp,frame_index,"
        "episode_index,index,task_index\n";
    int index = 0;
    const std::vector<int> lengths{4, 3, 5};
    for (int episode = 0; episode < 3; ++episode)
      for (int i = 0; i < lengths[episode]; ++i, ++index)
        table += fmt::format("{},{},{},{},{},{},{},{},{}\n", index, 0.5, 2.0, 0.1, 0.1 * i, i,
                             episode, index, episode == 2 && i > 2 ? 1 : 0);
    write(kTable, table);
    write_video(kVideo, index);
  }

  void write_video(const std::string& name, int frames) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    ASSERT_OK(testing::write_video(folder_ / name, frames,
                                   {.width = 64, .height = 48, .rate_numerator = 10}));
  }

  void write(const std::string& name, std::string_view text) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::filesystem::remove(folder_ / name);
    folder_.write(name, text);
  }

  /// Replaces `from` in a file.
  void change(const std::string& name, const std::string& from, const std::string& to) {
    std::string text = content_of(folder_ / name);
    const size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write(name, text.replace(at, from.size(), to));
  }

  /// Reads all there is into moments_ and report_.
  Status read(const ReadingOptions& options = {}) {
    moments_.clear();
    ENGRAM_ASSIGN_OR_RETURN(const auto reader,
                            make_lerobot_format()->open(folder_.path(), options));
    streams_ = reader->streams();
    while (true) {
      auto moment = reader->next();
      report_ = reader->report();
      if (!moment.ok()) return moment.status();
      if (!*moment) return {};
      moments_.push_back(**std::move(moment));
    }
  }

  /// What an entity is at a moment; empty where it is not.
  idf::Data value(size_t moment, const std::string& entity) const {
    for (const ltm::EntityUpdate& update : moments_.at(moment).commit.updates)
      if (update.entity.to_string() == entity) return update.instances[0].data;
    return {};
  }

  TemporaryDirectory folder_;
  std::vector<RecordingStream> streams_;
  std::vector<RecordingReader::Moment> moments_;
  ReadingReport report_;
};

}  // namespace engram::datasets::testing
