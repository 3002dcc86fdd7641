// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/message_type.h"

#include "datasets/ros/standard_definitions.h"
#include "tests/datasets/ros/example_messages.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets::ros {
namespace {

using idf::Dict;
using idf::List;
using idf::NdArray;

MessageType type_of(std::string_view name, const std::string& definition,
                    Serialization serialization) {
  auto type = MessageType::create(name, definition, serialization);
  ENGRAM_CHECK(type.ok(), "{}", type.status().message());
  return *std::move(type);
}

MessageType ros1_joints() {
  return type_of("sensor_msgs/JointState", std::string(kRos1JointState) + std::string(kRos1Header),
                 Serialization::kRos1);
}
MessageType cdr_joints() {
  return type_of("sensor_msgs/msg/JointState",
                 std::string(*standard_definition("sensor_msgs/JointState")), Serialization::kCdr);
}

idf::Data joints_value(Dict header) {
  return Dict{{"header", std::move(header)},
              {"name", List{"elbow", "wrist"}},
              {"position", NdArray::take<double>({2}, {0.5, -1.25})},
              {"velocity", NdArray::take<double>({0}, {})},
              {"effort", NdArray::take<double>({1}, {3.0})}};
}
idf::Data ros1_joints_value() {
  return joints_value({{"seq", int64_t{7}},
                       {"stamp", Dict{{"sec", int64_t{1645189616}}, {"nsec", int64_t{492182000}}}},
                       {"frame_id", "base"}});
}
idf::Data cdr_joints_value() {
  return joints_value({{"stamp", Dict{{"sec", 1645189616}, {"nanosec", int64_t{492182000}}}},
                       {"frame_id", "base"}});
}

TEST(MessageType, ReadsAndWritesWhatRos1Made) {
  const auto bytes = from_hex(kRos1JointStateBytes);
  const auto value = ros1_joints().decode(bytes);
  ASSERT_OK(value);
  EXPECT_EQ(*value, ros1_joints_value());
  const auto again = ros1_joints().encode(*value);
  ASSERT_OK(again);
  EXPECT_EQ(*again, bytes);
}

TEST(MessageType, ReadsAndWritesWhatFastCdrMade) {
  const auto bytes = from_hex(kCdrJointStateBytes);
  const auto value = cdr_joints().decode(bytes);
  ASSERT_OK(value);
  EXPECT_EQ(*value, cdr_joints_value());
  const auto again = cdr_joints().encode(*value);
  ASSERT_OK(again);
  EXPECT_EQ(*again, bytes);
}

TEST(MessageType, ReadsBigEndian) {
  const auto value = cdr_joints().decode(from_hex(kCdrJointStateBigEndianBytes));
  ASSERT_OK(value);
  EXPECT_EQ(*value, cdr_joints_value());
}

TEST(MessageType, AlignsNumbersOfAllSizes) {
  const MessageType type = type_of("a/Mixed", std::string(kMixedDefinition), Serialization::kCdr);
  const idf::Data expected = Dict{{"a", 7},
                                  {"b", 513},
                                  {"c", true},
                                  {"d", NdArray::take<uint64_t>({}, {0xfffffffffffffffeU})},
                                  {"e", 1.5F},
                                  {"f", "x"},
                                  {"g", -3},
                                  {"h", int64_t{-5}},
                                  {"i", NdArray::take<double>({3}, {1, 2, 3})},
                                  {"j", NdArray::take<uint16_t>({2}, {258, 3})},
                                  {"k", 255}};
  for (const std::string_view bytes : {kCdrMixedBytes, kCdrMixedBigEndianBytes}) {
    const auto value = type.decode(from_hex(bytes));
    ASSERT_OK(value);
    EXPECT_EQ(*value, expected);
  }
  const auto bytes = type.encode(expected);
  ASSERT_OK(bytes);
  EXPECT_EQ(bytes->size(), from_hex(kCdrMixedBytes).size());
  EXPECT_EQ(type.decode(*bytes).value(), expected);
}

TEST(MessageType, ReadsMessagesInLists) {
  const MessageType type =
      type_of("tf2_msgs/TFMessage", std::string(kRos1Transforms) + std::string(kRos1Header),
              Serialization::kRos1);
  const auto bytes = from_hex(kRos1TransformBytes);
  const auto value = type.decode(bytes);
  ASSERT_OK(value);
  ASSERT_NE(value->at("transforms/0/child_frame_id"), nullptr);
  EXPECT_EQ(*value->at("transforms/0/child_frame_id"), idf::Data("tool"));
  EXPECT_EQ(*value->at("transforms/0/transform/translation/x"), idf::Data(1.5));
  EXPECT_EQ(header_stamp(*value), time_from_ns(1645189616492182000));
  EXPECT_EQ(type.segment(nullptr), (SegmentNames{"RobotState", "Localization"}));
  EXPECT_EQ(type.encode(*value).value(), bytes);
}

TEST(MessageType, KeepsTextThatIsNoUtf8) {
  const MessageType type = type_of("std_msgs/String", "string data", Serialization::kRos1);
  const auto bytes = from_hex("02000000ff61");
  const auto value = type.decode(bytes);
  ASSERT_OK(value);
  EXPECT_EQ(*value->at("data"), idf::Data(NdArray::take<uint8_t>({2}, {0xff, 0x61})));
  EXPECT_EQ(type.encode(*value).value(), bytes);
}

TEST(MessageType, GivesAnEmptyStructureTheByteThatCdrHasForIt) {
  const MessageType type = type_of("std_msgs/Empty", "", Serialization::kCdr);
  EXPECT_OK(type.decode(from_hex("0001000000")));
  EXPECT_EQ(type.encode(Dict{}).value(), from_hex("0001000000"));
  EXPECT_TRUE(type_of("std_msgs/Empty", "", Serialization::kRos1).encode(Dict{}).value().empty());
}

TEST(MessageType, FailsOnEveryTruncation) {
  for (const bool is_cdr : {false, true}) {
    const MessageType type = is_cdr ? cdr_joints() : ros1_joints();
    const auto bytes = from_hex(is_cdr ? kCdrJointStateBytes : kRos1JointStateBytes);
    for (size_t size = 0; size < bytes.size(); ++size)
      EXPECT_FAILS(type.decode(std::span(bytes).first(size)), StatusCode::kDataLoss,
                   "sensor_msgs/JointState");
  }
}

TEST(MessageType, AllocatesNothingForHostileLengths) {
  const MessageType numbers = type_of("a/B", "float64[] x", Serialization::kRos1);
  EXPECT_FAILS(numbers.decode(from_hex("ffffffff00000000")), StatusCode::kDataLoss,
               "'x' needs 34359738360 bytes, 4 are left");
  const MessageType texts = type_of("a/B", "string[] x", Serialization::kRos1);
  EXPECT_FAILS(texts.decode(from_hex("ffffffff00000000")), StatusCode::kDataLoss, "are left");
  const MessageType empties = type_of("a/B", "E[] x\n========\nMSG: a/E\n", Serialization::kRos1);
  EXPECT_FAILS(empties.decode(from_hex("ffffffff")), StatusCode::kDataLoss, "without bytes");
  const MessageType fixed = type_of("a/B", "uint8[4294967295] x", Serialization::kRos1);
  EXPECT_FAILS(fixed.decode(from_hex("00")), StatusCode::kDataLoss, "needs 4294967295 bytes");
}

TEST(MessageType, SaysWhatOfAValueDoesNotFit) {
  const MessageType type = type_of("a/B", "uint8 x\nstring[2] y", Serialization::kCdr);
  const auto encode = [&](Dict value) { return type.encode(value); };
  EXPECT_FAILS(encode({{"x", 256}, {"y", List{"", ""}}}), StatusCode::kInvalidArgument, "'x'");
  EXPECT_FAILS(encode({{"x", 1}}), StatusCode::kInvalidArgument, "needs 'y'");
  EXPECT_FAILS(encode({{"x", 1}, {"y", List{""}}}), StatusCode::kInvalidArgument, "needs 2");
  EXPECT_FAILS(encode({{"x", 1}, {"y", List{"", ""}}, {"z", 1}}), StatusCode::kInvalidArgument,
               "no such field");
  EXPECT_OK(encode({{"x", int64_t{255}}, {"y", List{"", ""}}}));
}

}  // namespace
}  // namespace engram::datasets::ros
