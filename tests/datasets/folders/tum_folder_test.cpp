// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>

#include <fstream>

#include "datasets/folders/folder_formats.h"
#include "ltm/codec/png.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

using ::testing::ElementsAre;

class TumFolder : public ::testing::Test {
 protected:
  void write(const std::string& name, std::string_view content) {
    std::filesystem::create_directories((scratch_ / name).parent_path());
    overwrite_file(scratch_ / name, as_bytes(content));
  }

  void write_image(const std::string& name, const idf::NdArray& image) {
    const auto png = ltm::png_codec().encode(image);
    ASSERT_OK(png);
    write(name, as_text(*png));
  }

  /// A folder as the benchmark lays it out.
  void write_folder() {
    write_image("rgb/1.png", idf::NdArray::take<uint8_t>({1, 2, 3}, {1, 2, 3, 4, 5, 6}));
    write_image("depth/1.png", idf::NdArray::take<uint16_t>({1, 2, 1}, {5000, 65535}));
    write("rgb.txt", "# color images\n# timestamp filename\n1305031102.175304 rgb/1.png\n");
    write("depth.txt", "1305031102.160407 depth/1.png\n1305031102.194330 depth/2.png\n");
    write("groundtruth.txt",
          "1305031102.175304 1.5 -2 3e-1 0.1 0.2 0.3 0.9\n"
          "1305031102.175304 1 2 3 0 0 0 1\n");
    write("accelerometer.txt", "1305031102.2 0 0 9.81\n");
  }

  Status read(const ReadingOptions& options = {}) {
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, make_tum_format()->open(scratch_.path(), options));
    while (true) {
      ENGRAM_ASSIGN_OR_RETURN(auto moment, reader->next());
      report_ = reader->report();
      if (!moment) return {};
      for (auto& update : moment->commit.updates) updates_.push_back(std::move(update));
    }
  }

  ScratchDirectory scratch_;
  std::vector<ltm::EntityUpdate> updates_;
  ReadingReport report_;
};

TEST_F(TumFolder, ReadsTablesInTheOrderOfTime) {
  write_folder();
  ASSERT_TRUE(make_tum_format()->recognises(scratch_.path()));
  ASSERT_OK(read());
  std::vector<std::pair<std::string, int64_t>> found;
  for (const auto& update : updates_)
    found.emplace_back(update.entity.to_string(), to_ns(update.time) - 1305031102000000000);
  EXPECT_THAT(found,
              ElementsAre(std::pair("Vision/Depth/robot/depth", 160407000),
                          std::pair("Vision/RGB/robot/rgb", 175304000),
                          std::pair("RobotState/Localization/robot/groundtruth", 175304000),
                          std::pair("RobotState/Localization/robot/groundtruth", 175304001),
                          std::pair("RobotState/Proprioception/robot/accelerometer", 200000000)));
  EXPECT_EQ(report_.damaged, 1u);
  EXPECT_EQ(report_.not_carried.at("repeated times, moved by 1 ns"), 1u);
  EXPECT_EQ(
      updates_[0].instances[0].data,
      idf::Data(idf::Dict{{"depth", idf::NdArray::take<uint16_t>({1, 2, 1}, {5000, 65535})}}));
  EXPECT_EQ(
      updates_[2].instances[0].data,
      idf::Data(idf::Dict{{"position", idf::NdArray::take<double>({3}, {1.5, -2, 0.3})},
                          {"orientation", idf::NdArray::take<double>({4}, {0.9, 0.1, 0.2, 0.3})}}));
}

TEST_F(TumFolder, BeginsWhenItIsTold) {
  write_folder();
  ASSERT_OK(read({.start = time_from_ns(77)}));
  EXPECT_EQ(to_ns(updates_.front().time), 77);
}

TEST_F(TumFolder, ErrorsNameFileAndLine) {
  EXPECT_FAILS(read(), StatusCode::kInvalidArgument, "has none of rgb.txt");
  write("rgb.txt", "# \n1.5\n");
  EXPECT_FAILS(read(), StatusCode::kInvalidArgument,
               "rgb.txt': line 2 has 1 cells, needs 2: timestamp filename");
  write("rgb.txt", "x a.png\n");
  EXPECT_FAILS(read(), StatusCode::kInvalidArgument, "line 1");
  write("rgb.txt", "2 a.png\n1 b.png\n");
  EXPECT_FAILS(read(), StatusCode::kInvalidArgument,
               "line 2, column 'timestamp': found '1', needs a time behind");
  write("rgb.txt", std::string(70000, '1'));
  EXPECT_FAILS(read(), StatusCode::kInvalidArgument, "more than 65535 bytes");
}

TEST_F(TumFolder, ImagesThatAreMissingBrokenOrOutsideAreCounted) {
  write_image("deep.png", idf::NdArray::take<uint16_t>({1, 1, 1}, {1}));
  write("broken.png", "\x89PNG and nothing else, longer than a header");
  write("rgb.txt", "1 missing.png\n2 broken.png\n3 /etc/hostname\n4 ../x.png\n5 deep.png\n");
  ASSERT_OK(read());
  EXPECT_TRUE(updates_.empty());
  EXPECT_EQ(report_.damaged, 5u);
}

TEST_F(TumFolder, HostileTables) {
  write("rgb.txt", "");
  ASSERT_OK(read());
  EXPECT_TRUE(updates_.empty());
  for (const std::string time : {"nan", "99999999999", "."}) {
    write("rgb.txt", time + " a.png\n");
    EXPECT_FAILS(read(), StatusCode::kInvalidArgument, "rgb.txt': line 1");
  }
  write("rgb.txt", "9200000000 a.png\n");
  EXPECT_OK(read({.start = Time::max()}));
  write("rgb.txt", "1 a.png\n9200000000 a.png\n");
  EXPECT_FAILS(read({.start = Time::max()}), StatusCode::kInvalidArgument, "behind the year 2262");
  std::filesystem::remove(scratch_ / "rgb.txt");
  std::filesystem::create_symlink("/etc/passwd", scratch_ / "rgb.txt");
  EXPECT_FAILS(read(), StatusCode::kInvalidArgument, "is a link to");
  std::filesystem::remove(scratch_ / "rgb.txt");
  ASSERT_EQ(::mkfifo((scratch_ / "rgb.txt").c_str(), 0600), 0);
  EXPECT_FAILS(read(), StatusCode::kInvalidArgument, "rgb.txt': is no file");
}

}  // namespace
}  // namespace engram::datasets
