// SPDX-License-Identifier: Apache-2.0
#include "datasets/folders/seven_scenes_reader.h"

#include <sys/stat.h>

#include <cmath>

#include "datasets/folders/folder_formats.h"
#include "ltm/codec/png.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

using ::testing::ElementsAre;

class SevenScenesReaderTest : public ::testing::Test {
 protected:
  void write(const std::string& name, std::string_view content) {
    std::filesystem::create_directories((scratch_ / name).parent_path());
    overwrite_file(scratch_ / name, as_bytes(content));
  }

  void write_frame(const std::string& name, std::string_view pose) {
    const auto color = ltm::png_codec().encode(idf::NdArray::take<uint8_t>({1, 1, 3}, {1, 2, 3}));
    const auto depth = ltm::png_codec().encode(idf::NdArray::take<uint16_t>({1, 1, 1}, {65535}));
    ASSERT_OK(color);
    ASSERT_OK(depth);
    write(name + ".color.png", as_text(*color));
    write(name + ".depth.png", as_text(*depth));
    write(name + ".pose.txt", pose);
  }

  Status read(const ReadingOptions& options = {}) {
    ENGRAM_ASSIGN_OR_RETURN(const auto reader,
                            make_seven_scenes_format()->open(scratch_.path(), options));
    while (true) {
      ENGRAM_ASSIGN_OR_RETURN(auto moment, reader->next());
      damaged_ = reader->report().damaged;
      if (!moment) return {};
      moments_.push_back(*std::move(moment));
    }
  }

  static constexpr const char* kQuarterTurn = "0 -1 0 1.5\t \n 1 0 0 2 \n 0 0 1 -3 \n 0 0 0 1 \n";
  ScratchDirectory scratch_;
  std::vector<RecordingReader::Moment> moments_;
  uint64_t damaged_ = 0;
};

TEST_F(SevenScenesReaderTest, ReadsSequencesFrameByFrame) {
  write_frame("seq-01/frame-000000", kQuarterTurn);
  write_frame("seq-01/frame-000003", kQuarterTurn);
  write_frame("seq-02/frame-000000", kQuarterTurn);
  ASSERT_TRUE(make_seven_scenes_format()->recognises(scratch_.path()));
  ASSERT_OK(read());
  std::vector<std::string> episodes;
  std::vector<int64_t> times;
  for (const auto& moment : moments_) {
    if (moment.begins) episodes.push_back(moment.begins->name);
    EXPECT_EQ(moment.commit.updates.size(), 3u);
    times.push_back(to_ns(moment.commit.updates[0].time));
  }
  EXPECT_THAT(episodes, ElementsAre("seq-01", "seq-02"));
  EXPECT_THAT(times, ElementsAre(0, 100'000'000, 10'100'000'000));
  const idf::Data& pose = moments_[0].commit.updates[2].instances[0].data;
  EXPECT_EQ(*pose.at("position"), idf::Data(idf::NdArray::take<double>({3}, {1.5, 2, -3})));
  const auto& orientation = pose.at("orientation")->get<idf::NdArray>();
  EXPECT_NEAR(orientation.values<double>()[0], std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(orientation.values<double>()[3], std::sqrt(0.5), 1e-12);
}

TEST_F(SevenScenesReaderTest, MissingAndBrokenFilesAreCounted) {
  write_frame("frame-000001", "0 1 2");
  write_frame("frame-000002", "nan nan nan nan 0 0 0 0 0 0 0 0 0 0 0 1");
  write_frame("frame-000003", std::string(kQuarterTurn) + "7");
  write("frame-000004.color.png", "no PNG");
  ASSERT_OK(read());
  EXPECT_EQ(moments_.size(), 4u);
  EXPECT_EQ(damaged_, 6u);
}

TEST_F(SevenScenesReaderTest, FoldersWithoutFramesAreErrors) {
  write("frame-00.color.png", "");
  EXPECT_FALSE(make_seven_scenes_format()->recognises(scratch_.path()));
  EXPECT_FAILS(read(), StatusCode::kInvalidArgument, "has no frame-000000.color.png");
  write_frame("seq-01/frame-000000", kQuarterTurn);
  EXPECT_FAILS(read({.episodes = {"seq-09"}}), StatusCode::kInvalidArgument, "asked folders");
}

TEST_F(SevenScenesReaderTest, HostileFilesAreCountedAndTimesChecked) {
  write_frame("frame-000000", kQuarterTurn);
  std::filesystem::remove(scratch_ / "frame-000000.pose.txt");
  ASSERT_EQ(::mkfifo((scratch_ / "frame-000000.pose.txt").c_str(), 0600), 0);
  std::filesystem::remove(scratch_ / "frame-000000.color.png");
  std::filesystem::create_symlink("/etc/passwd", scratch_ / "frame-000000.color.png");
  ASSERT_OK(read());
  EXPECT_EQ(damaged_, 2u);
  write_frame("frame-000009", kQuarterTurn);
  EXPECT_FAILS(read({.start = Time::max()}), StatusCode::kInvalidArgument, "behind the year 2262");
  EXPECT_FAILS(read({.rate_hz = 1e-300}), StatusCode::kInvalidArgument, "needs 0.001 to 1e6");
}

}  // namespace
}  // namespace engram::datasets
