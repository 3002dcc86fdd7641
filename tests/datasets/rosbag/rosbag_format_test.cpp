// SPDX-License-Identifier: Apache-2.0
#include "datasets/rosbag/rosbag_format.h"

#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <map>

#include "datasets/recordings/import_recording.h"
#include "tests/datasets/rosbag/example_bags.h"

namespace engram::datasets::rosbag {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Pair;

using idf::NdArray;

const char* const kCompressions[] = {"none", "bz2", "lz4"};

/// What write_bag.py writes, by entity.
void expect_all(const Contents& contents) {
  EXPECT_EQ(contents.report, ReadingReport{});
  ASSERT_EQ(contents.updates.size(), 27U);
  std::map<std::string, std::vector<const ltm::EntityUpdate*>> found;
  for (const auto& update : contents.updates) found[update.entity.to_string()].push_back(&update);
  ASSERT_EQ(found.size(), 9U);
  const auto value = [&](const char* entity, std::string_view path) {
    const auto& updates = found[entity];
    EXPECT_EQ(updates.size(), 3U) << entity;
    const idf::Data* data = updates.size() < 3 ? nullptr : updates[2]->instances[0].data.at(path);
    return data == nullptr ? idf::Data() : *data;
  };
  EXPECT_EQ(value("Vision/RGB/robot/camera.rgb", "image"),
            idf::Data(NdArray::take<uint8_t>({2, 2, 3}, {2, 1, 2, 3, 4, 5, 2, 1, 2, 3, 4, 5})));
  EXPECT_EQ(value("Vision/RGB/robot/camera.bgr", "image"),
            idf::Data(NdArray::take<uint8_t>({2, 2, 3}, {2, 1, 2, 5, 4, 3, 2, 1, 2, 5, 4, 3})));
  EXPECT_EQ(value("Vision/RGB/robot/camera.mono", "image"),
            idf::Data(NdArray::take<uint8_t>({2, 2, 1}, {2, 1, 2, 3})));
  EXPECT_EQ(value("Vision/Depth/robot/camera.depth", "depth"),
            idf::Data(NdArray::take<uint16_t>({2, 2, 1}, {2, 1000, 2000, 65535})));
  const idf::Data picture = value("Vision/RGB/robot/camera.compressed", "image");
  ASSERT_TRUE(picture.is<NdArray>());
  EXPECT_EQ(picture.get<NdArray>().shape(), (idf::Shape{8, 8, 3}));
  EXPECT_NEAR(std::to_integer<int>(picture.get<NdArray>().bytes()[0]), 200, 4);
  EXPECT_EQ(value("RobotState/Proprioception/robot/joint_states", "position"),
            idf::Data(NdArray::take<double>({2}, {0.5, 2})));
  EXPECT_EQ(value("RobotState/Localization/robot/tf", "transforms/0/transform/translation/x"),
            idf::Data(2.0));
  EXPECT_EQ(value("RobotState/Localization/robot/pose", "pose/position/y"), idf::Data(2.0));
  EXPECT_EQ(value("Data/rosbag/robot/text", "data"), idf::Data("number 2"));
  const ltm::EntityUpdate& pose = *found["RobotState/Localization/robot/pose"][2];
  EXPECT_EQ(to_ns(pose.time), 1'700'000'000'200'000'000);
  EXPECT_EQ(to_ns(pose.instances[0].metadata.created), 1'600'000'000'000'000'002);
  EXPECT_EQ(pose.instances[0].metadata.arrived, pose.time);
}

TEST(RosbagFormat, ReadsWhatPythonsRosbagHasWritten) {
  for (const std::string name : kCompressions) {
    const auto contents = read_all(golden(name + ".bag"));
    ASSERT_OK(contents);
    expect_all(*contents);
  }
}

TEST(RosbagFormat, ReadsWhatPythonsRosbagWritesHere) {
  const ScratchDirectory scratch;
  const auto script =
      std::filesystem::path(ENGRAM_SOURCE_DIR) / "tests/datasets/rosbag/write_bag.py";
  for (const std::string name : kCompressions) {
    const auto path = scratch / (name + ".bag");
    const int status = std::system(
        fmt::format("/usr/bin/python3 '{}' '{}' {}", script.string(), path.string(), name).c_str());
    ASSERT_TRUE(WIFEXITED(status));
    if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "needs python3-rosbag and its messages";
    ASSERT_EQ(WEXITSTATUS(status), 0);
    const auto contents = read_all(path);
    ASSERT_OK(contents);
    expect_all(*contents);
  }
}

TEST(RosbagFormat, KeepsWhatTheBagSaysOfItsConnections) {
  const auto contents = read_all(golden("none.bag"));
  ASSERT_OK(contents);
  const auto text = std::ranges::find(contents->streams, "/text", &RecordingStream::name);
  ASSERT_NE(text, contents->streams.end());
  EXPECT_EQ(text->values, 3U);
  const idf::Data attributes(text->attributes);
  EXPECT_EQ(*attributes.at("type"), idf::Data("std_msgs/String"));
  EXPECT_EQ(*attributes.at("md5sum"), idf::Data("992ce8a1687cec8c8bd883ec73ca41d1"));
  EXPECT_EQ(*attributes.at("connection/callerid"), idf::Data("/talker"));
  EXPECT_EQ(*attributes.at("connection/latching"), idf::Data("1"));
}

TEST(RosbagFormat, TellsDefinitionsThatAreNotThoseOfTheirMd5Sum) {
  const ScratchDirectory scratch;
  const std::string records =
      text_connection(0, "/text", "string name\n") + text_message(0, 1, "a");
  std::ofstream(scratch / "a.bag") << bag_header(1, 1, 0) + records;
  const auto reader = open(scratch / "a.bag");
  ASSERT_OK(reader);
  EXPECT_THAT((*reader)->report().not_carried,
              Contains(Pair(HasSubstr("do not have the MD5 sum"), 1)));
}

TEST(RosbagFormat, ImportsIntoAStore) {
  const ScratchDirectory scratch;
  auto reader = open(golden("lz4.bag"), {.provider = "pr2"});
  ASSERT_OK(reader);
  EXPECT_EQ((*reader)->total(), 27U);
  auto recorder = ltm::Recorder::open(scratch / "store", {});
  ASSERT_OK(recorder);
  const auto imported = import_recording(**reader, "rosbag", *recorder, {}, {});
  ASSERT_OK(imported);
  ASSERT_OK(recorder->close());
  EXPECT_EQ(imported->values, 27U);
  EXPECT_EQ(imported->episodes, 1U);
  EXPECT_EQ(imported->reading, ReadingReport{});
}

TEST(RosbagFormat, MovesTheRecordingToAStart) {
  const auto contents =
      read_all(golden("none.bag"), {.start = time_from_ns(1'800'000'000'000'000'000)});
  ASSERT_OK(contents);
  EXPECT_EQ(to_ns(contents->updates[0].time), 1'800'000'000'000'000'000);
  EXPECT_EQ(to_ns(contents->updates[0].instances[0].metadata.created), 1'700'000'000'000'000'000);
}

TEST(RosbagFormat, KnowsBagsByHowTheyBegin) {
  const ScratchDirectory scratch;
  const auto format = make_rosbag_format();
  EXPECT_TRUE(format->recognises(golden("none.bag")));
  std::ofstream(scratch / "empty.bag");
  EXPECT_TRUE(format->recognises(scratch / "empty.bag"));
  std::ofstream(scratch / "text.bag") << "hello";
  EXPECT_FALSE(format->recognises(scratch / "text.bag"));
  EXPECT_TRUE(format->can_write());
}

TEST(RosbagFormat, RefusesEpisodesThatItHasNot) {
  EXPECT_FAILS(open(golden("none.bag"), {.episodes = {"demo_0"}}), StatusCode::kInvalidArgument,
               "demo_0");
  EXPECT_FAILS(open(golden("none.bag"), {.provider = ""}), StatusCode::kInvalidArgument,
               "provider");
}

}  // namespace
}  // namespace engram::datasets::rosbag
