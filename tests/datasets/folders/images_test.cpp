// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>

#include "datasets/folders/folder_formats.h"
#include "datasets/folders/images_folder.h"
#include "ltm/codec/codec.h"
#include "tests/ltm/expect_status.h"
#include "tests/ltm/scratch_directory.h"

namespace engram::datasets {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

constexpr auto kInvalid = StatusCode::kInvalidArgument;

class FolderTest : public ::testing::Test {
 protected:
  void write(const std::string& name, std::string_view content) {
    std::filesystem::create_directories((scratch_ / name).parent_path());
    overwrite_file(scratch_ / name, as_bytes(content));
  }

  void write_image(const std::string& name, const idf::NdArray& image) {
    const bool is_jpeg = name.ends_with(".jpg");
    const auto file = ltm::find_codec(is_jpeg ? "jpeg" : "png")->encode(image);
    ASSERT_OK(file);
    write(name, as_text(*file));
  }

  static idf::NdArray grey(uint8_t value) {
    return idf::NdArray::take<uint8_t>({1, 1, 1}, {value});
  }

  Status read_as(const RecordingFormat& format, const ReadingOptions& options = {}) {
    updates_.clear();
    ENGRAM_ASSIGN_OR_RETURN(const auto reader, format.open(scratch_.path(), options));
    streams_ = reader->streams();
    while (true) {
      auto moment = reader->next();
      report_ = reader->report();
      if (!moment.ok()) return moment.status();
      if (!*moment) return {};
      for (auto& update : (*moment)->commit.updates) updates_.push_back(std::move(update));
    }
  }

  std::vector<std::pair<std::string, int64_t>> found() const {
    std::vector<std::pair<std::string, int64_t>> all;
    for (const auto& update : updates_)
      all.emplace_back(update.entity.to_string(), to_ns(update.time));
    return all;
  }
  const idf::Data& value(size_t i) const { return updates_.at(i).instances[0].data; }

  ScratchDirectory scratch_;
  std::vector<RecordingStream> streams_;
  std::vector<ltm::EntityUpdate> updates_;
  ReadingReport report_;
};

class ImagesTest : public FolderTest {
 protected:
  Status read(const ReadingOptions& options = {}) {
    return read_as(*make_images_format(), options);
  }
};

TEST_F(ImagesTest, ReadsATableOfNamesTimesAndNumbers) {
  write_image("left/a.png", grey(1));
  write_image("left/b.jpg", grey(2));
  write("data.csv",
        "#timestamp [ns],filename,elbow,note\n1403636579763555584,a.png,0.5,warm\n"
        "1403636579763555585,b.jpg,-1e3,cold\n");
  ASSERT_TRUE(make_images_format()->recognises(scratch_.path()));
  ASSERT_OK(read());
  EXPECT_THAT(found(),
              ElementsAre(Pair("Vision/RGB/robot/left", 1403636579763555584),
                          Pair("RobotState/Proprioception/robot/data", 1403636579763555584),
                          Pair("Vision/RGB/robot/left", 1403636579763555585),
                          Pair("RobotState/Proprioception/robot/data", 1403636579763555585)));
  EXPECT_EQ(value(0), idf::Data(idf::Dict{{"image", grey(1)}}));
  EXPECT_EQ(value(3), idf::Data(idf::Dict{{"elbow", -1000.0}}));
  EXPECT_THAT(report_.not_carried, ElementsAre(Pair("column 'note', not of numbers", 1)));
}

TEST_F(ImagesTest, ReadsOneTimeForEachImageInTheOrderOfTheirNumbers) {
  write_image("9.png", grey(9));
  write_image("10.png", grey(10));
  write_image("100.png", grey(100));
  write("times.txt", "0.000000e+00\n1.036224e-01\n0.2\n");
  ASSERT_OK(read());
  EXPECT_THAT(found(), ElementsAre(Pair("Vision/RGB/robot/images", 0),
                                   Pair("Vision/RGB/robot/images", 103622400),
                                   Pair("Vision/RGB/robot/images", 200000000)));
  EXPECT_EQ(value(1), idf::Data(idf::Dict{{"image", grey(10)}}));
  ASSERT_OK(read({.start = time_from_ns(7)}));
  EXPECT_EQ(found().back().second, 200000007);
}

TEST_F(ImagesTest, ARateSaysWhenAndTheReportThatItDoes) {
  write_image("a.png", idf::NdArray::take<uint16_t>({1, 1, 1}, {500}));
  write("t.csv", "time,file\n12,a.png\n");
  EXPECT_FAILS(read(), kInvalid,
               "t.csv': line 2, column 'time': found '12', needs a unit in the column's name "
               "('timestamp [ns]'), or say --format images --value-rate 30");
  ASSERT_OK(read({.rate_hz = 30}));
  EXPECT_THAT(found(), ElementsAre(Pair("Vision/Depth/robot/images", 0)));
  EXPECT_THAT(report_.not_carried, ElementsAre(Pair("column 'time': the rate says when", 1)));
}

TEST_F(ImagesTest, WhatIsAmbiguousIsAnError) {
  EXPECT_FAILS(read(), kInvalid, "found images in 0 places (none)");
  write_image("left/a.png", grey(1));
  EXPECT_FAILS(read(), kInvalid, "found 0 tables (none), needs one, .csv or .txt");
  write("a.csv", "time_s\n1\n2\n");
  EXPECT_FAILS(read(), kInvalid, "a.csv': has 2 lines and '");
  write("b.txt", "1.5\n");
  EXPECT_FAILS(read(), kInvalid, "found 2 tables ('a.csv', 'b.txt')");
  EXPECT_FALSE(make_images_format()->recognises(scratch_.path()));
  write_image("right/a.png", grey(1));
  EXPECT_FAILS(read(), kInvalid, "found images in 2 places ('left', 'right')");
}

TEST_F(ImagesTest, HostileTables) {
  write_image("a.png", grey(1));
  const auto table = [&](std::string_view text) {
    write("t.csv", text);
    return read();
  };
  EXPECT_FAILS(table(""), kInvalid, "t.csv': is empty");
  EXPECT_FAILS(table("time_s,file\n"), kInvalid, "has a header but no lines");
  EXPECT_FAILS(table("x,file\n1,a.png\n"), kInvalid, "found the columns 'x', 'file', needs one of");
  EXPECT_FAILS(table("time_s,file\nnan,a.png\n"), kInvalid, "line 2, column 'time_s': found 'nan'");
  EXPECT_FAILS(table("time_s,file\n1e300,a.png\n"), kInvalid, "at most 292 years");
  EXPECT_FAILS(table("time_s,file\n2,a.png\n1,a.png\n"), kInvalid,
               "line 3, column 'time_s': found '1', needs a time behind");
  EXPECT_FAILS(table("time_s,file\n2,a.png\n1\n"), kInvalid, "line 3 has 1 cells, needs 2");
  EXPECT_FAILS(table("time_s,file,x\n2,a.png,1\n3,a.png,y\n"), kInvalid,
               "line 3, column 'x': found 'y', needs a number");
  EXPECT_FAILS(table("time_s,file\n2,\"a.png\n"), kInvalid, "line 2");
  ASSERT_OK(table("time_s,file\n1,/etc/passwd.png\n2,../a.png\n3,none.png\n3,a.png\n"));
  EXPECT_EQ(report_.damaged, 3u);
  EXPECT_THAT(found(), ElementsAre(Pair("Vision/RGB/robot/images", 3'000'000'001)));
}

TEST_F(ImagesTest, LinksOutOfTheFolderAndPipes) {
  const ScratchDirectory elsewhere;
  write_image("a.png", grey(1));
  std::filesystem::rename(scratch_ / "a.png", elsewhere / "a.png");
  std::filesystem::create_symlink(elsewhere / "a.png", scratch_ / "a.png");
  ASSERT_EQ(::mkfifo((scratch_ / "b.png").c_str(), 0600), 0);
  write("t.csv", "time_s,file\n1,a.png\n2,b.png\n");
  ASSERT_OK(read());
  EXPECT_EQ(report_.damaged, 2u);
  std::filesystem::rename(scratch_ / "t.csv", elsewhere / "t.csv");
  std::filesystem::create_symlink(elsewhere / "t.csv", scratch_ / "t.csv");
  EXPECT_FAILS(read(), kInvalid, "is a link to");
}

TEST(TimeName, SaysTheUnit) {
  EXPECT_EQ(time_name("timestamp [ns]").unit, TimeUnit::kNanoseconds);
  EXPECT_EQ(time_name("Time(ms)").unit, TimeUnit::kMilliseconds);
  EXPECT_EQ(time_name("t_us").unit, TimeUnit::kMicroseconds);
  EXPECT_EQ(time_name("stamp_sec").unit, TimeUnit::kSeconds);
  EXPECT_TRUE(time_name("time").is_time);
  EXPECT_FALSE(time_name("time").unit);
  EXPECT_FALSE(time_name("time_of_flight").is_time);
  EXPECT_FALSE(time_name("").is_time);
}

class EurocTest : public FolderTest {
 protected:
  void SetUp() override {
    write_image("mav0/cam0/data/1403636579763555584.png", grey(1));
    write("mav0/cam0/data.csv",
          "#timestamp [ns],filename\r\n1403636579763555584,1403636579763555584.png\r\n");
    write("mav0/cam0/sensor.yaml", "rate_hz: 20\n");
    write("mav0/imu0/data.csv",
          "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
          "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
          "1403636579758555392,-0.1,0.2,0.3,8.1,-0.4,-2.5\n");
    write("mav0/leica0/data.csv",
          "#timestamp [ns], p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m]\n1403636579763555584,4,5,6\n");
    write("mav0/state_groundtruth_estimate0/data.csv",
          "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [],"
          " q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1],"
          " b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad s^-1], b_w_RS_S_z [rad s^-1],"
          " b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n"
          "1403636580838555648,1,2,3,0.5,0.5,0.5,0.5,4,5,6,7,8,9,10,11,12\n");
    write("mav0/radar0/data.csv", "a\n");
  }
};

TEST_F(EurocTest, ReadsSensorsInTheOrderOfTime) {
  ASSERT_TRUE(make_euroc_format()->recognises(scratch_.path()));
  ASSERT_OK(read_as(*make_euroc_format()));
  EXPECT_THAT(found(),
              ElementsAre(Pair("RobotState/Proprioception/robot/imu0", 1403636579758555392),
                          Pair("Vision/RGB/robot/cam0", 1403636579763555584),
                          Pair("RobotState/Localization/robot/leica0", 1403636579763555584),
                          Pair("RobotState/Localization/robot/state_groundtruth_estimate0",
                               1403636580838555648)));
  EXPECT_EQ(*value(0).at("linear_acceleration"),
            idf::Data(idf::NdArray::take<double>({3}, {8.1, -0.4, -2.5})));
  EXPECT_EQ(*value(3).at("orientation"),
            idf::Data(idf::NdArray::take<double>({4}, {0.5, 0.5, 0.5, 0.5})));
  EXPECT_EQ(*value(3).at("accelerometer_bias"),
            idf::Data(idf::NdArray::take<double>({3}, {10, 11, 12})));
  EXPECT_EQ(streams_[0].attributes.find("sensor")->get<std::string>(), "rate_hz: 20\n");
  EXPECT_THAT(report_.not_carried, ElementsAre(Pair("folder 'radar0': no known sensor", 1)));
}

TEST_F(EurocTest, TablesThatDoNotFit) {
  write("mav0/imu0/data.csv", "#timestamp [ns],w\n1,2\n");
  EXPECT_FAILS(read_as(*make_euroc_format()), kInvalid,
               "imu0/data.csv': line 1 has 2 columns, needs 7");
  write("mav0/imu0/data.csv", "");
  EXPECT_FAILS(read_as(*make_euroc_format()), kInvalid, "imu0/data.csv': is empty");
  std::filesystem::remove_all(scratch_ / "mav0");
  EXPECT_FAILS(read_as(*make_euroc_format()), kInvalid, "has no folder cam0");
}

}  // namespace
}  // namespace engram::datasets
