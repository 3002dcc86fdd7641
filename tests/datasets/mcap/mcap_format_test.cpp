// SPDX-License-Identifier: Apache-2.0
#include "datasets/mcap/mcap_format.h"

#include "datasets/ros/standard_definitions.h"
#include "tests/datasets/mcap/example_files.h"
#include "tests/datasets/recordings/format_stores.h"
#include "tests/datasets/ros/example_messages.h"

namespace engram::datasets::mcap {
namespace {

using idf::Dict;
using idf::List;
using idf::NdArray;

NdArray picture(int64_t seed, int64_t channels = 3) {
  std::vector<uint8_t> pixels(static_cast<size_t>(16 * 24 * channels));
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>(seed + i / 5);
  return NdArray::take({16, 24, channels}, std::move(pixels));
}

ltm::MemoryId entity(std::string_view text) {
  return ltm::MemoryId::parse(text).value();
}

class McapFormatTest : public testing::Test {
 protected:
  /// A recording of ROS 2, ROS 1 and others, as foreign programs write it.
  std::filesystem::path write_foreign() const {
    const auto path = scratch_ / "foreign.mcap";
    auto writer = McapWriter::create(
        path, {.chunk_bytes = 2000, .compression = "lz4", .profile = "ros2", .library = "test"});
    EXPECT_OK(writer);
    const auto image = std::string(*ros::standard_definition("sensor_msgs/Image"));
    writer->add(SchemaRecord{1, "sensor_msgs/msg/Image", "ros2msg", image});
    writer->add(SchemaRecord{2, "sensor_msgs/JointState", "ros1msg",
                             std::string(ros::kRos1JointState) + std::string(ros::kRos1Header)});
    writer->add(SchemaRecord{3, "Pose", "protobuf", "\xff\x01"});
    writer->add(SchemaRecord{4, "reward", "jsonschema", "{}"});
    writer->add(ChannelRecord{1, 1, "/cam/colour", "cdr", {{"qos", "- depth: 1"}}});
    writer->add(ChannelRecord{2, 1, "/cam/depth", "cdr", {}});
    writer->add(ChannelRecord{3, 2, "/joint_states", "ros1", {}});
    writer->add(ChannelRecord{4, 3, "/pose", "protobuf", {}});
    writer->add(ChannelRecord{5, 4, "/reward", "json", {}});
    writer->add(ChannelRecord{6, 0, "/unused", "cbor", {}});
    EXPECT_OK(writer->write(MetadataRecord{"robot", {{"arm", "left"}}}));
    const auto type =
        ros::MessageType::create("sensor_msgs/Image", image, ros::Serialization::kCdr).value();
    const auto joints = ros::from_hex(ros::kRos1JointStateBytes);
    for (uint32_t i = 0; i < 5; ++i) {
      const uint64_t time = 1'700'000'000'000'000'000 + uint64_t{i} * 100'000'000;
      const Dict header{{"stamp", Dict{{"sec", 1'600'000'000}, {"nanosec", int64_t{i}}}},
                        {"frame_id", "camera"}};
      const auto colour =
          type.encode(Dict{{"image", picture(i)}, {"header", header}, {"encoding", "bgr8"}});
      const auto depth = type.encode(
          Dict{{"depth", NdArray::take<uint16_t>({1, 2, 1}, {static_cast<uint16_t>(i), 7})},
               {"header", header},
               {"encoding", "16UC1"}});
      const std::string json = fmt::format(R"({{"$x": {}, "y": [1.5, null, "a"]}})", i);
      EXPECT_OK(writer->write(MessageRecord{1, i, time, time - 5, *colour}));
      EXPECT_OK(writer->write(MessageRecord{2, i, time, time - 4, *depth}));
      EXPECT_OK(writer->write(MessageRecord{3, i, time + 1, time, joints}));
      EXPECT_OK(writer->write(MessageRecord{4, i, time + 2, time, as_bytes("\xfe\x00z")}));
      EXPECT_OK(writer->write(MessageRecord{5, i, time + 3, time, as_bytes(json)}));
    }
    EXPECT_OK(writer->write(
        AttachmentRecord{1'700'000'000'100'000'000, 5, "notes", "text/plain", as_bytes("hello")}));
    EXPECT_OK(writer->close());
    return path;
  }

  ScratchDirectory scratch_;
  FormatStores mcap_{make_mcap_format()};
};

TEST_F(McapFormatTest, KnowsItsFilesByHowTheyBegin) {
  const auto format = make_mcap_format();
  EXPECT_TRUE(format->recognises(write_foreign()));
  std::ofstream(scratch_ / "other.mcap") << "#ROSBAG V2.0";
  EXPECT_FALSE(format->recognises(scratch_ / "other.mcap"));
  std::ofstream(scratch_ / "cut.mcap") << "\x89MCAP";
  EXPECT_TRUE(format->recognises(scratch_ / "cut.mcap"));
  EXPECT_FALSE(format->recognises(scratch_ / "none.mcap"));
  EXPECT_FALSE(format->recognises(scratch_.path()));
}

TEST_F(McapFormatTest, GivesMessagesTheirPlaces) {
  const auto contents = read_all(write_foreign());
  ASSERT_OK(contents);
  EXPECT_EQ(contents->report, ReadingReport{});
  std::vector<std::string> entities;
  for (const auto& stream : contents->streams) entities.push_back(stream.entity.to_string());
  EXPECT_THAT(entities,
              testing::ElementsAre("Vision/RGB/robot/cam.colour", "Vision/Depth/robot/cam.depth",
                                   "RobotState/Proprioception/robot/joint_states",
                                   "Data/mcap/robot/pose", "Data/mcap/robot/reward",
                                   "Data/mcap/robot/unused", "Data/mcap/robot/attachments"));
  ASSERT_EQ(contents->updates.size(), 26U);
  const ltm::EntityUpdate& colour = contents->updates[0];
  EXPECT_EQ(*colour.instances[0].data.at("image"), idf::Data(picture(0)));
  EXPECT_EQ(to_ns(colour.time), 1'700'000'000'000'000'000);
  EXPECT_EQ(to_ns(colour.instances[0].metadata.created), 1'600'000'000'000'000'000);
  EXPECT_EQ(to_ns(colour.instances[0].metadata.sent), 1'699'999'999'999'999'995);
  EXPECT_EQ(colour.instances[0].metadata.arrived, colour.time);
  EXPECT_EQ(contents->updates[4].instances[0].data,
            idf::Data(Dict{{"$x", int64_t{0}}, {"y", List{1.5, idf::None{}, "a"}}}));
}

TEST_F(McapFormatTest, MovesTheRecordingToAStart) {
  const auto contents =
      read_all(write_foreign(), {.start = time_from_ns(1'800'000'000'000'000'000)});
  ASSERT_OK(contents);
  EXPECT_EQ(to_ns(contents->updates[0].time), 1'800'000'000'000'000'000);
  EXPECT_EQ(to_ns(contents->updates[0].instances[0].metadata.created), 1'700'000'000'000'000'000);
}

TEST_F(McapFormatTest, LosesNothingOnTheWayThroughAStore) {
  const auto foreign = write_foreign();
  const auto imported = mcap_.import(foreign, scratch_ / "store");
  ASSERT_OK(imported);
  EXPECT_EQ(imported->values, 26U);
  EXPECT_THAT(mcap_.not_held(scratch_ / "store"), testing::IsEmpty());
  const auto written = mcap_.write(scratch_ / "store", scratch_ / "again.mcap");
  ASSERT_OK(written);
  EXPECT_EQ(written->instances, 26U);
  EXPECT_THAT(written->not_carried, testing::IsEmpty());
  const auto before = read_all(foreign);
  const auto after = read_all(scratch_ / "again.mcap");
  ASSERT_OK(after);
  EXPECT_EQ(after->report, ReadingReport{});
  EXPECT_EQ(*idf::Data(after->episodes[0].attributes).at("profile"), idf::Data("ros2"));
  EXPECT_EQ(*idf::Data(after->episodes[0].attributes).at("metadata"),
            *idf::Data(before->episodes[0].attributes).at("metadata"));
  ASSERT_EQ(after->updates.size(), before->updates.size());
  const auto by_time = [](const ltm::EntityUpdate& a, const ltm::EntityUpdate& b) {
    return std::tuple(a.time, a.entity) < std::tuple(b.time, b.entity);
  };
  auto first = before->updates;
  auto second = after->updates;
  std::ranges::sort(first, by_time);
  std::ranges::sort(second, by_time);
  EXPECT_EQ(second, first);
  EXPECT_THAT(after->streams, testing::UnorderedElementsAreArray(before->streams));
}

TEST_F(McapFormatTest, GivesEntitiesThatNoImportMadeBackAsTheyWere) {
  const auto store = scratch_ / "store";
  const auto doubles = [](std::vector<double> values) {
    const auto size = static_cast<int64_t>(values.size());
    return NdArray::take({size}, std::move(values));
  };
  const std::map<std::string, idf::Data> values{
      {"Vision/RGB/head/cam", Dict{{"image", picture(1)}}},
      {"Vision/RGB/head/grey", Dict{{"image", picture(2, 1)}}},
      {"Vision/Depth/head/cam", Dict{{"depth", NdArray::take<float>({1, 2, 1}, {0.5F, 2})}}},
      {"Vision/RGB/head/linked", Dict{{"image", picture(3)}, {"state", "a/b/c/d"}}},
      {"RobotState/Proprioception/arm/joints", Dict{{"name", List{"a", "b"}},
                                                    {"position", doubles({1, 2})},
                                                    {"velocity", doubles({})},
                                                    {"effort", doubles({})}}},
      {"Tasks/Feedback/arm/reward", 0.5F},
      {"Data/x/y/z\\/z", List{1, int64_t{2}, true, idf::None{}, picture(4)}}};
  for (const auto& [name, value] : values) FormatStores::record(store, name, {value, value});
  ASSERT_OK(mcap_.write(store, scratch_ / "out.mcap"));
  const auto contents = read_all(scratch_ / "out.mcap");
  ASSERT_OK(contents);
  EXPECT_EQ(contents->updates.size(), 2 * values.size());
  for (const auto& update : contents->updates) {
    ASSERT_TRUE(values.contains(update.entity.to_string())) << update.entity.to_string();
    EXPECT_EQ(update.instances[0].data, values.at(update.entity.to_string()));
  }
}

TEST_F(McapFormatTest, CountsValuesThatTheirChannelCannotHold) {
  FormatStores::record(
      scratch_ / "store", "Vision/RGB/head/cam",
      {Dict{{"image", picture(1)}, {"label", "cup"}}, Dict{{"image", picture(2)}}});
  const auto report = mcap_.write(scratch_ / "store", scratch_ / "out.mcap");
  ASSERT_OK(report);
  EXPECT_EQ(report->instances, 1U);
  EXPECT_EQ(
      report->not_carried.at("values of 'Vision/RGB/head/cam' that are no messages of its type"),
      1U);
}

TEST_F(McapFormatTest, CompressesPicturesWhereAsked) {
  FormatStores::record(scratch_ / "store", "Vision/RGB/head/cam", {Dict{{"image", picture(1)}}});
  ASSERT_OK(mcap_.write(scratch_ / "store", scratch_ / "out.mcap", {.jpeg_quality = 90}));
  const auto contents = read_all(scratch_ / "out.mcap");
  ASSERT_OK(contents);
  ASSERT_EQ(contents->updates.size(), 1U);
  const idf::Data* image = contents->updates[0].instances[0].data.at("image");
  ASSERT_NE(image, nullptr);
  EXPECT_EQ(image->get<NdArray>().shape(), (idf::Shape{16, 24, 3}));
  EXPECT_EQ(*idf::Data(contents->streams[0].attributes).at("schema/name"),
            idf::Data("sensor_msgs/msg/CompressedImage"));
}

TEST_F(McapFormatTest, SaysBeforehandWhatItCannotHold) {
  auto recorder = ltm::Recorder::open(scratch_ / "store", {});
  ASSERT_OK(recorder);
  const Time time = time_from_ns(5);
  ltm::InstanceMetadata sure{.created = time, .sent = time, .arrived = time, .provider = "x"};
  ltm::InstanceMetadata unsure = sure;
  unsure.confidence = 0.5F;
  ASSERT_OK(recorder->commit({{{entity("A/B/C/d"), time, {{1.0, unsure}, {2.0, sure}}}}}));
  ASSERT_OK(recorder->close());
  EXPECT_THAT(
      mcap_.not_held(scratch_ / "store"),
      testing::UnorderedElementsAre(testing::Pair("instances beyond the first of a snapshot", 1U),
                                    testing::Pair("confidence", 1U)));
  const auto report = mcap_.write(scratch_ / "store", scratch_ / "out.mcap");
  ASSERT_OK(report);
  EXPECT_EQ(report->not_carried.at("instances beyond the first of a snapshot"), 1U);
}

TEST_F(McapFormatTest, RefusesEpisodesThatItHasNot) {
  EXPECT_FAILS(open(write_foreign(), {.episodes = {"demo_0"}}), StatusCode::kInvalidArgument,
               "demo_0");
  EXPECT_FAILS(open(golden("OneMessage-ch-chx-mx-rch-rsh-st.mcap"), {.provider = ""}),
               StatusCode::kInvalidArgument, "provider");
}

}  // namespace
}  // namespace engram::datasets::mcap
