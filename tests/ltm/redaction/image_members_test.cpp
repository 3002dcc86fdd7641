// SPDX-License-Identifier: Apache-2.0
#include "ltm/redaction/image_members.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

namespace engram::ltm {
namespace {

using idf::ElementType;
using idf::NdArray;
using ::testing::ElementsAre;

std::vector<std::string> paths_of(idf::Data value) {
  std::vector<std::string> paths;
  for (const ImageMember& member : find_images(value).members) paths.push_back(member.path);
  return paths;
}

template <typename T>
NdArray array(idf::Shape shape, T value = {}) {
  int64_t count = 1;
  for (const int64_t size : shape) count *= size;
  return NdArray::take(std::move(shape), std::vector<T>(static_cast<size_t>(count), value));
}

TEST(ImageMembers, AreFoundWhereverTheyAreInAValue) {
  const idf::Data value =
      idf::Dict{{"rgb", array<uint8_t>({48, 64, 3})},
                {"depth", array<float>({48, 64})},
                {"more", idf::List{idf::Dict{{"a/b", array<uint16_t>({48, 64, 1})}}, idf::Data(3)}},
                {"planes", array<float>({3, 48, 64})},
                {"video", array<uint8_t>({5, 48, 64, 3})},
                {"two", array<uint8_t>({2, 48, 64})},
                {"depths", array<float>({9, 48, 64})},
                {"stereo", array<uint8_t>({48, 64, 6})},
                {"five axes", array<float>({2, 3, 48, 64, 1})}};
  EXPECT_THAT(paths_of(value), ElementsAre("rgb", "depth", "more/0/a\\/b", "planes", "video", "two",
                                           "depths", "stereo", "five axes"));
  EXPECT_THAT(paths_of(idf::Data(array<uint8_t>({8, 8, 1}))), ElementsAre(""));
}

TEST(ImageMembers, AreNotSeenInPosesCloudsAndTables) {
  const idf::Data value =
      idf::Dict{{"pose", array<double>({4, 4})},           {"joints", array<float>({100, 7})},
                {"cloud", array<float>({1000, 6})},        {"table", array<double>({500, 20})},
                {"features", array<float>({16, 16, 256})}, {"text", "no image"},
                {"bytes", array<uint8_t>({1000})},         {"empty", array<uint8_t>({0, 0, 3})}};
  EXPECT_THAT(paths_of(value), ElementsAre());
}

/// Why no detector can look.
std::string unreadable(idf::Data value) {
  return find_images(value).unreadable;
}

NdArray bytes_of(std::string begin, size_t size = 200) {
  begin.resize(size);
  return NdArray::take({static_cast<int64_t>(size)},
                       std::vector<uint8_t>(begin.begin(), begin.end()));
}

TEST(ImageMembers, AreToldFromFilesOfImagesInBytes) {
  using namespace std::string_literals;
  const auto pads = [](const std::string& begin) { return begin + std::string(100, 'x'); };
  for (const std::string& begin :
       {"\xFF\xD8\xFF\xE0"s, "\x89PNG\r\n\x1A\n"s, "RIFF....WEBP"s, "....ftypavif"s,
        "data:image/jpeg;base64,"s, "P3\n"s, "P6\n64 48\n255\n"s, "twelve bytes\x89PNG\r\n\x1A\n"s,
        // H.264: parameters, delimiter, information, a whole image, one that refers to others.
        "\0\0\0\1\x67"s, "\0\0\1\x67"s, "\0\0\0\1\x09\x10"s, "\0\0\1\x06"s, "\0\0\1\x65"s,
        "\0\0\0\1\x41"s,
        // HEVC, MPEG 2 and 4, AV1, Ogg.
        "\0\0\1\x40\1"s, "\0\0\0\1\x46\1"s, "\0\0\0\1\x4E\1"s, "\0\0\0\1\2\1"s, "\0\0\1\xB3"s,
        "\0\0\1\xB6"s, "\x12\0\x0A\x0B"s, "OggS.................\x80theora"s})
    EXPECT_THAT(unreadable(idf::Dict{{"a", idf::List{bytes_of(pads(begin))}}}),
                ::testing::StartsWith("'a/0' is a file of an image"))
        << begin;
  // H.264 with lengths: two units that fill the bytes.
  std::string units(200, 'x');
  units.replace(0, 5, "\0\0\0\x60\x67"s);
  units.replace(100, 5, "\0\0\0\x60\x65"s);
  EXPECT_NE(unreadable(bytes_of(units)), "");
  EXPECT_EQ(unreadable(bytes_of(units, 199)), "");
  for (const std::string& begin : {"what anybody writes"s, "RIFF....WAVE"s, "OggS....OpusHead"s,
                                   "P6 is not a map"s, std::string(16, '\0')})
    EXPECT_EQ(unreadable(bytes_of(pads(begin))), "") << begin;
  EXPECT_NE(unreadable(std::string("\x89PNG\r\n\x1A\n and so on, as a text")), "");
  EXPECT_EQ(unreadable(NdArray::take({4}, std::vector<uint8_t>{0xFF, 0xD8, 0xFF, 0})), "");
}

TEST(ImageMembers, AreToldFromMessagesWithPixelsAsBytes) {
  const NdArray bytes = bytes_of("anything", 64 * 48);
  const auto message = [&](const std::string& encoding) {
    return idf::Dict{{"height", int64_t{48}},
                     {"width", int32_t{64}},
                     {"encoding", encoding},
                     {"step", int64_t{64}},
                     {"data", bytes}};
  };
  for (const char* encoding : {"bayer_rggb8", "yuv422", "nv12", "nobody knows", "hevc"})
    EXPECT_THAT(unreadable(idf::Dict{{"seen", message(encoding)}}),
                ::testing::StartsWith("'seen/data' is an image or video as bytes"))
        << encoding;
  for (const char* format : {"jpeg", "16UC1; compressedDepth rvl", "H264", "rgb8; png compressed "})
    EXPECT_NE(unreadable(idf::Dict{{"format", format}, {"data", bytes}}), "") << format;
  EXPECT_EQ(unreadable(idf::Dict{{"format", "opus"}, {"data", bytes}}), "");
  // A point cloud, the parameters of a camera, an image that is an array.
  EXPECT_EQ(unreadable(idf::Dict{{"height", int64_t{1}},
                                 {"width", int64_t{100}},
                                 {"point_step", int64_t{16}},
                                 {"data", bytes}}),
            "");
  EXPECT_EQ(unreadable(idf::Dict{{"height", int64_t{48}},
                                 {"width", int64_t{64}},
                                 {"D", NdArray::take({5}, std::vector<double>(5))},
                                 {"distortion_model", "plumb_bob"}}),
            "");
  EXPECT_EQ(
      unreadable(idf::Dict{
          {"height", int64_t{48}}, {"width", int64_t{64}}, {"image", array<uint8_t>({48, 64, 3})}}),
      "");
}

TEST(ImageMembers, AreNotPassedOverInALayoutThatNobodyKnows) {
  EXPECT_EQ(unreadable(array<uint8_t>({48, 3, 64})),
            "'' of shape [48, 3, 64] may be images, in which no detector looks");
  EXPECT_NE(unreadable(array<uint16_t>({1, 48, 5, 64})), "");
  EXPECT_EQ(unreadable(array<float>({100, 7, 50})), "");
  EXPECT_EQ(unreadable(array<uint8_t>({48, 3, 4})), "");
}

TEST(ImageMembers, AreStretchedToBytes) {
  auto depth = array<float>({8, 8, 1}, 1.0f);
  std::vector<float> values(64, 1.0f);
  values[1] = 3.0f;
  values[2] = std::numeric_limits<float>::quiet_NaN();
  values[3] = std::numeric_limits<float>::infinity();
  values[4] = 2.0f;
  depth = NdArray::take({8, 8, 1}, values);
  const auto layout = image_layout_of(depth.type(), depth.shape());
  ASSERT_TRUE(layout);
  const GreyOrRgb seen = pixels_of(depth, *layout, 0);
  EXPECT_EQ(seen.channels, 1);
  EXPECT_THAT(std::vector<uint8_t>(seen.pixels.begin(), seen.pixels.begin() + 5),
              ElementsAre(0, 255, 0, 0, 127));
  const double huge = std::numeric_limits<double>::max();
  std::vector<double> wide(64, -huge);
  wide[0] = huge;
  const NdArray doubles = NdArray::take({8, 8, 1}, wide);
  EXPECT_EQ(pixels_of(doubles, *layout, 0).pixels[0], 255);
  EXPECT_EQ(pixels_of(doubles, *layout, 0).pixels[1], 0);
}

TEST(ImageMembers, ShowPlanesAndTheFourthChannelAsRgb) {
  std::vector<uint8_t> planes(3 * 64), four(4 * 64, 9);
  for (size_t i = 0; i < planes.size(); ++i) planes[i] = static_cast<uint8_t>(i / 64 * 100);
  const NdArray chw = NdArray::take({3, 8, 8}, planes);
  const auto seen = pixels_of(chw, *image_layout_of(chw.type(), chw.shape()), 0);
  EXPECT_EQ(seen.channels, 3);
  EXPECT_THAT(std::vector<uint8_t>(seen.pixels.begin(), seen.pixels.begin() + 3),
              ElementsAre(0, 100, 200));
  const NdArray rgba = NdArray::take({8, 8, 4}, four);
  EXPECT_EQ(pixels_of(rgba, *image_layout_of(rgba.type(), rgba.shape()), 0).pixels.size(), 192u);
}

TEST(ImageMembers, ShowEveryChannelInOneLookOrAnother) {
  const auto looks = [](const idf::Shape& shape, int64_t channel_step, int64_t column_step) {
    int64_t count = 1;
    for (const int64_t size : shape) count *= size;
    std::vector<uint8_t> values(static_cast<size_t>(count));
    for (int64_t i = 0; i < count; ++i)
      values[static_cast<size_t>(i)] =
          static_cast<uint8_t>(i / channel_step % (column_step == 1 ? 100 : column_step));
    const NdArray image = NdArray::take(shape, values);
    const ImageLayout layout = *image_layout_of(image.type(), image.shape());
    std::vector<std::vector<uint8_t>> first;
    for (int64_t look = 0; look < layout.looks(); ++look) {
      const GreyOrRgb seen = pixels_of(image, layout, 0, look);
      EXPECT_EQ(seen.pixels.size(), static_cast<size_t>(64 * seen.channels));
      first.emplace_back(seen.pixels.begin(), seen.pixels.begin() + seen.channels);
    }
    return first;
  };
  using Looks = std::vector<std::vector<uint8_t>>;
  EXPECT_EQ(looks({2, 8, 8}, 64, 1), (Looks{{0}, {1}}));
  EXPECT_EQ(looks({4, 8, 8}, 64, 1), (Looks{{0, 1, 2}, {3}}));
  EXPECT_EQ(looks({8, 8, 2}, 1, 2), (Looks{{0}, {1}}));
  EXPECT_EQ(looks({8, 8, 6}, 1, 6), (Looks{{0, 1, 2}, {3}, {4}, {5}}));
  EXPECT_EQ(looks({5, 8, 8}, 64, 1), (Looks{{0}})) << "five images of one channel";
}

/// The distinct values of one channel in a part of an RGB image.
size_t values_in(const NdArray& image, const ImagePart& part) {
  std::set<uint8_t> values;
  for (int64_t y = part.top; y < part.bottom; ++y)
    for (int64_t x = part.left; x < part.right; ++x)
      values.insert(image.values<uint8_t>()[static_cast<size_t>((y * image.shape()[1] + x) * 3)]);
  return values.size();
}

TEST(Pixelate, LeavesAtMostEightBlocksAlongASide) {
  std::mt19937 random(1);
  std::vector<uint8_t> noise(200 * 160 * 3);
  for (uint8_t& each : noise) each = static_cast<uint8_t>(random());
  for (const auto& [width, height] : {std::pair{120, 100}, {16, 16}, {8, 120}, {5, 3}, {1, 1}}) {
    NdArray image = NdArray::take({160, 200, 3}, noise);
    const auto layout = *image_layout_of(image.type(), image.shape());
    const ImagePart part{0, 10, 20, 10 + width, 20 + height};
    pixelate(image, layout, {part});
    EXPECT_LE(values_in(image, part), 64u);
    if (width <= kMinBlock && height <= kMinBlock) {
      EXPECT_EQ(values_in(image, part), 1u);
    }
    // Nothing else changes.
    const NdArray given = NdArray::take({160, 200, 3}, noise);
    EXPECT_EQ(image.values<uint8_t>()[(20 * 200 + 9) * 3],
              given.values<uint8_t>()[(20 * 200 + 9) * 3]);
    const size_t right = (20 * 200 + 10 + static_cast<size_t>(width)) * 3;
    EXPECT_EQ(image.values<uint8_t>()[right], given.values<uint8_t>()[right]);
  }
}

TEST(Pixelate, TakesTheMeanOfNumbersOfEveryKind) {
  const auto check = [](auto value, auto other) {
    using T = decltype(value);
    std::vector<T> values(64, value);
    values[0] = other;
    NdArray image = NdArray::take({8, 8, 1}, values);
    pixelate(image, *image_layout_of(image.type(), image.shape()), {{0, 0, 0, 2, 1}});
    return image.values<T>()[0];
  };
  EXPECT_EQ(check(uint8_t{10}, uint8_t{20}), 15);
  EXPECT_EQ(check(int8_t{-10}, int8_t{20}), 5);
  EXPECT_EQ(check(uint16_t{1000}, uint16_t{2000}), 1500);
  EXPECT_EQ(check(int32_t{-1000}, int32_t{2000}), 500);
  EXPECT_EQ(check(std::numeric_limits<int64_t>::max(), std::numeric_limits<int64_t>::max()),
            std::numeric_limits<int64_t>::max());
  EXPECT_EQ(check(std::numeric_limits<uint64_t>::max(), std::numeric_limits<uint64_t>::max()),
            std::numeric_limits<uint64_t>::max());
  EXPECT_EQ(check(1.0f, 2.0f), 1.5f);
  EXPECT_EQ(check(1.0f, std::numeric_limits<float>::quiet_NaN()), 1.0f);
  EXPECT_EQ(check(std::numeric_limits<double>::max(), std::numeric_limits<double>::max()),
            std::numeric_limits<double>::max());
}

TEST(Fill, LeavesZerosInACopy) {
  const NdArray given = array<uint8_t>({3, 16, 16}, 7);
  NdArray image = given;
  fill(image, *image_layout_of(image.type(), image.shape()), {{0, 2, 3, 5, 6}});
  EXPECT_EQ(std::ranges::count(image.values<uint8_t>(), 0), 3 * 3 * 3);
  EXPECT_EQ(std::ranges::count(given.values<uint8_t>(), 0), 0);
}

}  // namespace
}  // namespace engram::ltm
