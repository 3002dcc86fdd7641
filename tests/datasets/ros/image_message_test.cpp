// SPDX-License-Identifier: Apache-2.0
#include "datasets/ros/image_message.h"

#include "datasets/ros/standard_definitions.h"
#include "tests/datasets/ros/example_messages.h"
#include "tests/ltm/expect_status.h"

namespace engram::datasets::ros {
namespace {

using idf::Dict;
using idf::NdArray;

MessageType standard(std::string_view name) {
  return MessageType::create(name, *standard_definition(name), Serialization::kCdr).value();
}

Dict image_fields(const std::string& encoding, int64_t width, int64_t step,
                  std::vector<uint8_t> data) {
  const auto size = static_cast<int64_t>(data.size());
  return Dict{{"header", Dict{}},
              {"height", size / step},
              {"width", width},
              {"encoding", encoding},
              {"is_bigendian", 0},
              {"step", step},
              {"data", NdArray::take({size}, std::move(data))}};
}

TEST(ImageMessage, MakesRgbOfWhatRos1Made) {
  const std::string definition =
      "Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\n"
      "uint32 step\nuint8[] data\n" +
      std::string(kRos1Header);
  const auto type = MessageType::create("sensor_msgs/Image", definition, Serialization::kRos1);
  ASSERT_OK(type);
  const auto value = type->decode(from_hex(kRos1ImageBytes));
  ASSERT_OK(value);
  // The fourth byte of each row pads it.
  EXPECT_EQ(*value->at("image"), idf::Data(NdArray::take<uint8_t>({2, 1, 3}, {3, 2, 1, 6, 5, 4})));
  EXPECT_EQ(header_stamp(*value), time_from_ns(1645189616492182000));
  EXPECT_EQ(type->segment(&*value), (SegmentNames{"Vision", "RGB"}));
  const auto again = type->decode(type->encode(*value).value());
  ASSERT_OK(again);
  EXPECT_EQ(*again, *value);
}

TEST(ImageMessage, KeepsEveryEncodingBothWays) {
  const std::vector<std::tuple<std::string, int64_t, std::string>> encodings{
      {"rgb8", 3, "image"},      {"bgr8", 3, "image"},  {"rgba8", 4, "image"},
      {"bgra8", 4, "image"},     {"mono8", 1, "image"}, {"mono16", 2, "image"},
      {"16UC1", 2, "depth"},     {"32FC1", 4, "depth"}, {"8UC3", 3, "image"},
      {"bayer_rggb8", 1, "data"}};
  for (const auto& [encoding, pixel_bytes, member] : encodings) {
    std::vector<uint8_t> data;
    for (int64_t i = 0; i < 6 * pixel_bytes; ++i) data.push_back(static_cast<uint8_t>(40 + i));
    const idf::Data message = image_fields(encoding, 3, 3 * pixel_bytes, std::move(data));
    const idf::Data picture = picture_of_image(message);
    EXPECT_NE(picture.at(member), nullptr) << encoding;
    const auto again = image_of_picture(picture);
    ASSERT_OK(again);
    EXPECT_EQ(*again->at("data"), *message.at("data")) << encoding;
    EXPECT_EQ(*again->at("encoding"), *message.at("encoding"));
    EXPECT_EQ(*again->at("step"), *message.at("step"));
  }
}

TEST(ImageMessage, TurnsBigEndianDepth) {
  Dict fields = image_fields("16UC1", 2, 4, {1, 2, 3, 4});
  fields.set("is_bigendian", 1);
  EXPECT_EQ(*picture_of_image(fields).at("depth"),
            idf::Data(NdArray::take<uint16_t>({1, 2, 1}, {0x0102, 0x0304})));
}

TEST(ImageMessage, LeavesWhatContradictsItself) {
  EXPECT_NE(picture_of_image(image_fields("rgb8", 3, 8, std::vector<uint8_t>(16))).at("data"),
            nullptr);
  Dict fields = image_fields("rgb8", 1, 3, std::vector<uint8_t>(6));
  fields.set("height", int64_t{1} << 40);
  EXPECT_NE(picture_of_image(fields).at("data"), nullptr);
}

TEST(ImageMessage, CompressesAsPngWithoutLossAndAsJpegWhereAsked) {
  const MessageType type = standard("sensor_msgs/CompressedImage");
  std::vector<uint8_t> pixels(16 * 16 * 3);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<uint8_t>(i / 4);
  const idf::Data picture = Dict{{"image", NdArray::take({16, 16, 3}, std::move(pixels))}};
  const auto png = type.encode(picture);
  ASSERT_OK(png);
  const auto again = type.decode(*png);
  ASSERT_OK(again);
  EXPECT_EQ(*again->at("image"), *picture.at("image"));
  const auto jpeg = type.encode(picture, 90);
  ASSERT_OK(jpeg);
  const auto lossy = type.decode(*jpeg);
  ASSERT_OK(lossy);
  ASSERT_NE(lossy->at("image"), nullptr);
  EXPECT_EQ(lossy->at("image")->get<NdArray>().shape(), (idf::Shape{16, 16, 3}));
}

TEST(ImageMessage, LeavesCompressedBytesThatAreNoPicture) {
  for (const std::vector<uint8_t>& data :
       {std::vector<uint8_t>{}, {1, 2, 3}, {0xff, 0xd8, 0xff, 0xe0, 0, 0, 0, 0, 0, 0, 0, 0, 0}}) {
    const auto size = static_cast<int64_t>(data.size());
    const idf::Data message = Dict{{"header", Dict{}},
                                   {"format", "jpeg"},
                                   {"data", NdArray::take({size}, std::vector<uint8_t>(data))}};
    EXPECT_EQ(picture_of_compressed(message), message);
  }
}

TEST(ImageMessage, RefusesMembersThatWouldBeLost) {
  const NdArray pixel = NdArray::take<uint8_t>({1, 1, 3}, {1, 2, 3});
  const NdArray alpha = NdArray::take<uint8_t>({1, 1, 1}, {1});
  for (const char* name : {"sensor_msgs/Image", "sensor_msgs/CompressedImage"}) {
    const auto encode = [&](Dict value) { return standard(name).encode(value); };
    EXPECT_OK(encode({{"image", pixel}}));
    EXPECT_FAILS(encode({{"image", pixel}, {"label", "cup"}}), StatusCode::kInvalidArgument,
                 "'label'");
    EXPECT_FAILS(encode({{"image", pixel}, {"depth", pixel}}), StatusCode::kInvalidArgument,
                 "needs one of them");
    EXPECT_FAILS(encode({{"image", pixel}, {"alpha", alpha}}), StatusCode::kInvalidArgument,
                 "'alpha'");
  }
}

TEST(ImageMessage, GivesDepthAPlaceOfItsOwn) {
  const MessageType type = standard("sensor_msgs/Image");
  const idf::Data depth = Dict{{"depth", NdArray::take<float>({1, 2, 1}, {0.5F, 2})}};
  EXPECT_EQ(type.segment(&depth), (SegmentNames{"Vision", "Depth"}));
  const auto value = type.decode(type.encode(depth).value());
  ASSERT_OK(value);
  EXPECT_EQ(*value->at("depth"), *depth.at("depth"));
  EXPECT_EQ(*value->at("encoding"), idf::Data("32FC1"));
}

}  // namespace
}  // namespace engram::datasets::ros
