// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/suited_type.h"

#include "datasets/ros/standard_definitions.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets::ros {
namespace {

using idf::Dict;
using idf::NdArray;

MessageType image_type(Serialization serialization) {
  return MessageType::create("sensor_msgs/Image",
                             *standard_definition("sensor_msgs/Image", serialization),
                             serialization)
      .value();
}

const idf::Data kImage = Dict{{"image", NdArray::take<uint8_t>({1, 2, 1}, {1, 2})}};

TEST(BareValues, ComeBackWithAStamp) {
  const Time stamp = time_from_ns(1'700'000'000'000'000'005);
  for (const auto serialization : {Serialization::kRos1, Serialization::kCdr}) {
    const MessageType type = image_type(serialization);
    const auto bytes = encode_bare(type, kImage, 0, stamp);
    ASSERT_OK(bytes);
    const auto message = type.decode(*bytes);
    ASSERT_OK(message);
    EXPECT_EQ(header_stamp(*message), stamp);
    EXPECT_EQ(without_header(*message), kImage);
  }
}

TEST(BareValues, HaveNoStampThatAHeaderCannotHold) {
  const MessageType type = image_type(Serialization::kRos1);
  for (const int64_t ns : {int64_t{-1}, int64_t{1} << 62}) {
    const auto bytes = encode_bare(type, kImage, 0, time_from_ns(ns));
    ASSERT_OK(bytes);
    EXPECT_EQ(header_stamp(type.decode(*bytes).value()), std::nullopt);
  }
}

TEST(BareValues, MayHaveNoHeaderOfTheirOwn) {
  const Dict value{{"image", NdArray::take<uint8_t>({1, 2, 1}, {1, 2})}, {"header", "mine"}};
  EXPECT_FAILS(encode_bare(image_type(Serialization::kRos1), value, 0),
               StatusCode::kInvalidArgument, "'header'");
}

}  // namespace
}  // namespace engram::datasets::ros
