// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <map>

#include "datasets/mcap/mcap_format.h"
#include "tests/datasets/recordings/format_stores.h"
#include "tests/datasets/rosbag/example_bags.h"

namespace engram::datasets::rosbag {
namespace {

using idf::Dict;
using idf::List;
using idf::NdArray;
using testing::IsEmpty;
using testing::Pair;
using testing::UnorderedElementsAre;

const Time kTime = time_from_ns(1'700'000'000'000'000'000);

NdArray picture(int64_t seed, int64_t channels = 3) {
  std::vector<uint8_t> pixels(static_cast<size_t>(16 * 24 * channels));
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>(seed + i / 5);
  return NdArray::take({16, 24, channels}, std::move(pixels));
}

NdArray doubles(std::vector<double> values) {
  const auto size = static_cast<int64_t>(values.size());
  return NdArray::take({size}, std::move(values));
}

std::vector<ltm::EntityUpdate> sorted(std::vector<ltm::EntityUpdate> updates) {
  std::ranges::sort(updates, [](const ltm::EntityUpdate& a, const ltm::EntityUpdate& b) {
    return std::tuple(a.time, a.entity) < std::tuple(b.time, b.entity);
  });
  return updates;
}

class BagExportTest : public testing::Test {
 protected:
  /// From a bag through a store to another bag, and what is in that.
  [[nodiscard]] Contents passed_on(const std::filesystem::path& bag) const {
    EXPECT_OK(bags_.import(bag, store_));
    EXPECT_THAT(bags_.not_held(store_), IsEmpty());
    const auto written = bags_.write(store_, out_);
    EXPECT_OK(written);
    EXPECT_THAT(written->not_carried, IsEmpty());
    return read_all(out_).value();
  }

  ScratchDirectory scratch_;
  std::filesystem::path store_ = scratch_ / "store";
  std::filesystem::path out_ = scratch_ / "out.bag";
  FormatStores bags_{make_rosbag_format()};
};

TEST_F(BagExportTest, LosesNothingOfABagOnItsWayThroughAStore) {
  const auto before = read_all(golden("bz2.bag"));
  ASSERT_OK(before);
  const Contents after = passed_on(golden("bz2.bag"));
  EXPECT_EQ(after.report, ReadingReport{});
  EXPECT_EQ(sorted(after.updates), sorted(before->updates));
  EXPECT_THAT(after.streams, testing::UnorderedElementsAreArray(before->streams));
}

/// Times and values, in order, whoever measured them when.
std::vector<std::tuple<Time, ltm::MemoryId, idf::Data>> values_of(const Contents& contents) {
  std::vector<std::tuple<Time, ltm::MemoryId, idf::Data>> values;
  for (const ltm::EntityUpdate& update : sorted(contents.updates))
    values.emplace_back(update.time, update.entity, update.instances.at(0).data);
  return values;
}

TEST_F(BagExportTest, LosesNoMessageOnItsWayThroughAnMcapFile) {
  const FormatStores mcaps{make_mcap_format()};
  const auto before = read_all(golden("bz2.bag"));
  ASSERT_OK(before);
  ASSERT_OK(bags_.import(golden("bz2.bag"), store_));
  ASSERT_OK(mcaps.write(store_, scratch_ / "a.mcap"));
  // Of the episode.
  EXPECT_THAT(mcaps.not_held(store_),
              testing::Contains(Pair("descriptions of other formats' streams", 1u)));
  ASSERT_OK(mcaps.import(scratch_ / "a.mcap", scratch_ / "second"));
  EXPECT_FALSE(bags_.not_held(scratch_ / "second")
                   .contains("types of values: written as JSON in "
                             "std_msgs/String"));
  const auto written = bags_.write(scratch_ / "second", out_);
  ASSERT_OK(written);
  EXPECT_THAT(written->not_carried, IsEmpty());
  const auto after = read_all(out_);
  ASSERT_OK(after);
  EXPECT_EQ(values_of(*after), values_of(*before));
  ASSERT_EQ(after->streams.size(), before->streams.size());
  for (const RecordingStream& stream : before->streams) {
    const auto same = std::ranges::find(after->streams, stream.entity, &RecordingStream::entity);
    ASSERT_NE(same, after->streams.end()) << stream.entity.to_string();
    EXPECT_EQ(same->name, stream.name);
    for (const char* key : {"type", "md5sum", "definition"})
      EXPECT_EQ(*same->attributes.find(key), *stream.attributes.find(key)) << stream.name;
  }
}

TEST_F(BagExportTest, TellsDescriptionsOfChannelsThatBagsHaveNot) {
  const FormatStores mcaps{make_mcap_format()};
  FormatStores::record(store_, "Data/x/robot/number", {idf::Data(1.5)});
  ASSERT_OK(mcaps.write(store_, scratch_ / "a.mcap"));
  ASSERT_OK(mcaps.import(scratch_ / "a.mcap", scratch_ / "second"));
  const auto told = bags_.not_held(scratch_ / "second");
  EXPECT_EQ(told.at("descriptions of other formats' streams"), 2u);  // Of the episode and a stream.
  EXPECT_EQ(told.at("types of values: written as JSON in std_msgs/String"), 1u);
}

// More than nine, of which some are silent, and one that cannot be read.
TEST_F(BagExportTest, GivesEveryConnectionOfOneTopicItsNameBack) {
  constexpr uint32_t kConnections = 12;
  std::string records;
  for (uint32_t i = 0; i < kConnections; ++i)
    records += text_connection(i, "/text", i == 7 ? "no definition" : "string data\n");
  for (uint32_t i = 0; i < kConnections; ++i)
    if (i % 5 != 0) records += text_message(i, 10 + i, std::to_string(i));
  std::ofstream(scratch_ / "in.bag") << bag_header(1, kConnections, 0) + records;
  const auto before = read_all(scratch_ / "in.bag");
  ASSERT_OK(before);
  const Contents after = passed_on(scratch_ / "in.bag");
  EXPECT_EQ(after.updates, before->updates);
  EXPECT_EQ(after.streams, before->streams);
}

TEST_F(BagExportTest, GivesEntitiesThatNoImportMadeBackAsTheyWere) {
  const std::map<std::string, idf::Data> values{
      {"Vision/RGB/head/cam", Dict{{"image", picture(1)}}},
      {"Vision/RGB/head/grey", Dict{{"image", picture(2, 1)}}},
      {"Vision/Depth/head/cam", Dict{{"depth", NdArray::take<float>({1, 2, 1}, {0.5F, 2})}}},
      {"Vision/RGB/head/linked", Dict{{"image", picture(3)}, {"state", "a/b/c/d"}}},
      {"RobotState/Proprioception/arm/joints", Dict{{"name", List{"a", "b"}},
                                                    {"position", doubles({1, 2})},
                                                    {"velocity", doubles({})},
                                                    {"effort", doubles({})}}},
      {"Speech/Heard/head/said", Dict{{"text", "hello \xc3\xa4"}}},
      {"Speech/Heard/head/data", Dict{{"data", ""}}},
      {"Speech/Heard/head/string", "plain"},
      {"Tasks/Feedback/arm/reward", 0.5F},
      {"Data/x/y/z\\/z", List{1, int64_t{2}, true, idf::None{}, picture(4)}}};
  for (const auto& [name, value] : values) FormatStores::record(store_, name, {value, value});
  EXPECT_THAT(
      bags_.not_held(store_),
      UnorderedElementsAre(Pair("types of values: written as JSON in std_msgs/String", 3U)));
  ASSERT_OK(bags_.write(store_, out_));
  const auto contents = read_all(out_);
  ASSERT_OK(contents);
  EXPECT_EQ(contents->updates.size(), 2 * values.size());
  for (const auto& update : contents->updates) {
    ASSERT_TRUE(values.contains(update.entity.to_string())) << update.entity.to_string();
    EXPECT_EQ(update.instances[0].data, values.at(update.entity.to_string()));
  }
  std::map<std::string, std::string> types;
  for (const RecordingStream& stream : contents->streams)
    types[stream.name] = idf::Data(stream.attributes).at("type")->get<std::string>();
  EXPECT_EQ(types.at("/Vision/RGB/head/cam"), "sensor_msgs/Image");
  EXPECT_EQ(types.at("/RobotState/Proprioception/arm/joints"), "sensor_msgs/JointState");
  EXPECT_EQ(types.at("/Speech/Heard/head/said"), "std_msgs/String");
  EXPECT_EQ(types.at("/Vision/RGB/head/linked"), "std_msgs/String");

  // And once more: the connections say whose they are.
  ASSERT_OK(bags_.import(out_, scratch_ / "again"));
  ASSERT_OK(bags_.write(scratch_ / "again", scratch_ / "again.bag"));
  const auto again = read_all(scratch_ / "again.bag");
  ASSERT_OK(again);
  EXPECT_EQ(sorted(again->updates), sorted(contents->updates));
  EXPECT_THAT(again->streams, testing::UnorderedElementsAreArray(contents->streams));
}

TEST_F(BagExportTest, GivesEachEntityATopicOfItsOwnThatRosAccepts) {
  for (const char* name : {"A/B/c/d.e", "A/B/c/d e", "A/B/c/d_e"})
    FormatStores::record(store_, name, {"text"});
  ASSERT_OK(bags_.write(store_, out_));
  const auto contents = read_all(out_);
  ASSERT_OK(contents);
  std::vector<std::string> topics;
  for (const RecordingStream& stream : contents->streams) topics.push_back(stream.name);
  EXPECT_THAT(topics, UnorderedElementsAre("/A/B/c/d_e", "/A/B/c/d_e_2", "/A/B/c/d_e_3"));
}

TEST_F(BagExportTest, StampsPicturesWithTheTimeOfTheirCreation) {
  auto recorder = ltm::Recorder::open(store_, {});
  ASSERT_OK(recorder);
  const Time created = kTime - Duration(12'345'678'901);
  const ltm::InstanceMetadata times{
      .created = created, .sent = kTime, .arrived = kTime, .provider = "x"};
  for (const auto& [name, value] :
       std::map<std::string, idf::Data>{{"Vision/RGB/head/cam", Dict{{"image", picture(1)}}},
                                        {"Tasks/Feedback/arm/reward", 0.5}})
    ASSERT_OK(recorder->commit({{{ltm::MemoryId::parse(name).value(), kTime, {{value, times}}}}}));
  ASSERT_OK(recorder->close());
  EXPECT_THAT(
      bags_.not_held(store_),
      UnorderedElementsAre(Pair("types of values: written as JSON in std_msgs/String", 1U),
                           Pair("times of creation, where messages have no header with them", 1U)));
  ASSERT_OK(bags_.write(store_, out_));
  const auto contents = read_all(out_);
  ASSERT_OK(contents);
  for (const auto& update : contents->updates) {
    EXPECT_EQ(update.time, kTime);
    const bool is_picture = update.entity.names()[0] == "Vision";
    EXPECT_EQ(update.instances[0].metadata.created, is_picture ? created : kTime);
  }
}

TEST_F(BagExportTest, SaysBeforehandWhatItCannotHold) {
  auto recorder = ltm::Recorder::open(store_, {});
  ASSERT_OK(recorder);
  ltm::InstanceMetadata sure{.created = kTime, .sent = kTime, .arrived = kTime, .provider = "x"};
  ltm::InstanceMetadata unsure = sure;
  unsure.confidence = 0.5F;
  unsure.sent = kTime - Duration(1);
  const auto entity = ltm::MemoryId::parse("A/B/C/d").value();
  ASSERT_OK(recorder->commit({{{entity, kTime, {{"a", unsure}, {"b", sure}}}}}));
  const auto of_mcap = stream_entity("mcap", entity);
  ASSERT_OK(recorder->commit(
      {{imported(of_mcap, kTime, RecordingStream{entity, "/d", 1, {}}.to_data())}}));
  ASSERT_OK(recorder->close());
  EXPECT_THAT(bags_.not_held(store_),
              UnorderedElementsAre(Pair("instances beyond the first of a snapshot", 1U),
                                   Pair("confidence", 1U), Pair("times of sending and arrival", 1U),
                                   Pair("descriptions of other formats' streams", 1U)));
  const auto report = bags_.write(store_, out_);
  ASSERT_OK(report);
  EXPECT_EQ(report->not_carried.at("instances beyond the first of a snapshot"), 1U);
}

TEST_F(BagExportTest, CountsWhatItCannotCarry) {
  FormatStores::record(
      store_, "Vision/RGB/head/cam",
      {Dict{{"image", picture(1)}, {"label", "cup"}}, Dict{{"image", picture(2)}}});
  FormatStores::record(store_, "A/B/c/early", {"a", "b"}, time_from_ns(-1));
  FormatStores::record(store_, "A/B/c/late", {"a", "b"},
                       time_from_ns(4'294'967'296'000'000'000 - 1));
  const auto report = bags_.write(store_, out_);
  ASSERT_OK(report);
  EXPECT_EQ(report->instances, 3U);
  EXPECT_THAT(report->not_carried,
              UnorderedElementsAre(
                  Pair("values of 'Vision/RGB/head/cam' that are no messages of its type", 1U),
                  Pair("values before 1970", 1U), Pair("values from 2106 on", 1U)));
}

TEST_F(BagExportTest, CompressesPicturesWhereAsked) {
  FormatStores::record(store_, "Vision/RGB/head/cam", {Dict{{"image", picture(1)}}});
  const WritingOptions options{.jpeg_quality = 90};
  EXPECT_THAT(bags_.not_held(store_, options),
              UnorderedElementsAre(Pair("exact pixels: JPEG was asked for", 1U)));
  ASSERT_OK(bags_.write(store_, out_, options));
  const auto contents = read_all(out_);
  ASSERT_OK(contents);
  ASSERT_EQ(contents->updates.size(), 1U);
  const idf::Data* image = contents->updates[0].instances[0].data.at("image");
  ASSERT_NE(image, nullptr);
  EXPECT_EQ(image->get<NdArray>().shape(), (idf::Shape{16, 24, 3}));
  EXPECT_EQ(*idf::Data(contents->streams[0].attributes).at("type"),
            idf::Data("sensor_msgs/CompressedImage"));
}

TEST_F(BagExportTest, CountsTextsThatAreNotTheJsonTheyClaimToBe) {
  const std::string connection =
      record_of(Opcode::kConnection, {{"conn", number_field(uint32_t{0})}, {"topic", "/text"}},
                fields_of({{"type", "std_msgs/String"},
                           {"md5sum", "*"},
                           {"message_definition", "string data\n"},
                           {"engram:entity", "A/B/C/d"},
                           {"engram:form", "json"}}));
  std::ofstream(out_) << bag_header(1, 1, 0) + connection + text_message(0, 1, "{\"a\": 5}") +
                             text_message(0, 2, "{\"a\"");
  const auto contents = read_all(out_);
  ASSERT_OK(contents);
  ASSERT_EQ(contents->updates.size(), 1U);
  EXPECT_EQ(contents->updates[0].entity.to_string(), "A/B/C/d");
  EXPECT_EQ(contents->updates[0].instances[0].data, idf::Data(Dict{{"a", int64_t{5}}}));
  EXPECT_EQ(contents->report.damaged, 1U);
}

}  // namespace
}  // namespace engram::datasets::rosbag
